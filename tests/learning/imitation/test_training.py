"""Short trainings of the thesis' heads on the committed data set."""

import hashlib
import json
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file

from keypush.learning.checkpoint import load_network
from keypush.learning.imitation.module import ImitationModule
from keypush.learning.imitation.train import NETWORKS
from tests.learning.imitation.sample import train, write_encoder


@pytest.fixture(scope="module")
def encoder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_encoder(tmp_path_factory.mktemp("encoder") / "contact.safetensors")


@pytest.mark.parametrize(
    ("kind", "cache"), [("keypoint", True), ("keypoint", False), ("behavior_cloning", True)]
)
def test_the_head_learns_and_the_encoder_stays(
    kind: str, cache: bool, encoder: Path, tmp_path: Path
) -> None:
    metrics = train(kind, tmp_path, encoder, cache=cache)
    losses = [entry["loss"] for entry in metrics["history"]]
    assert losses[-1] < 0.9 * losses[0]
    network = load_network(tmp_path / f"{kind}.safetensors", NETWORKS[kind])
    weights, given = network.state_dict(), load_file(encoder)
    of_encoder = [name for name in weights if name.startswith("encoder.")]
    assert len(of_encoder) == sum(name.startswith("encoder.") for name in given)
    for name in of_encoder:
        assert torch.equal(weights[name], given[name]), name
    assert network.config.use_com
    # The head's file does not repeat the encoder, which lies beside it.
    assert not set(load_file(tmp_path / f"{kind}.safetensors")) & set(of_encoder)
    assert (tmp_path / encoder.name).read_bytes() == encoder.read_bytes()


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("keypoint", {"error_mean", "error_p90", "error_xy_mean", "error_lateral_mean"}),
        ("behavior_cloning", {"translation_mm_mean", "rotation_mrad_mean"}),
    ],
)
def test_the_card_tells_how_it_came_about(
    kind: str, names: set[str], encoder: Path, tmp_path: Path
) -> None:
    metrics = train(kind, tmp_path, encoder, epochs=1)
    card = json.loads((tmp_path / f"{kind}.json").read_text())
    assert card["kind"] == kind
    assert card["metrics"] == metrics
    assert names <= metrics["validation"].keys()
    assert names <= metrics["held_out_objects"]["mug"].keys()
    digest = hashlib.sha256(encoder.read_bytes()).hexdigest()
    assert card["encoder"] == {"file": "contact.safetensors", "sha256": digest}
    assert card["data"]["trained_rows"] == 15 * 60
    assert "mug" not in card["data"]["objects"]
    assert card["data"]["held_out_objects"] == ["mug"]
    assert {"command", "git_revision", "training", "network"} <= card.keys()


def test_a_finished_training_started_again_was_made_by_whom_it_was(
    encoder: Path, tmp_path: Path
) -> None:
    path = tmp_path / "keypoint.json"
    train("keypoint", tmp_path, encoder, epochs=1)
    made = json.loads(path.read_text()) | {
        "git_revision": "earlier",
        "command": ["keypush", "of old"],
    }
    path.write_text(json.dumps(made))
    train("keypoint", tmp_path, encoder, epochs=1)
    assert json.loads(path.read_text()) == made
    (tmp_path / "keypoint.safetensors").unlink()
    train("keypoint", tmp_path, encoder, epochs=1)
    assert json.loads(path.read_text())["git_revision"] != "earlier"


@pytest.mark.parametrize("cache", [True, False])
def test_resumed_run_ends_with_the_same_bits(
    cache: bool, encoder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    once = train("keypoint", tmp_path / "once", encoder, cache=cache, rows_per_object=20)
    original = ImitationModule.batches

    def interrupted(self, epoch):  # type: ignore[no-untyped-def]  # stands in for batches
        if epoch == 2:
            raise KeyboardInterrupt
        return original(self, epoch)

    monkeypatch.setattr(ImitationModule, "batches", interrupted)
    with pytest.raises(KeyboardInterrupt):
        train("keypoint", tmp_path / "twice", encoder, cache=cache, rows_per_object=20)
    monkeypatch.undo()
    assert not (tmp_path / "twice" / "keypoint.safetensors").exists()
    twice = train("keypoint", tmp_path / "twice", encoder, cache=cache, rows_per_object=20)
    assert once == twice
    weights = [load_file(tmp_path / name / "keypoint.safetensors") for name in ("once", "twice")]
    assert all(torch.equal(value, weights[1][name]) for name, value in weights[0].items())


def test_the_seed_decides_the_loss_curve(encoder: Path, tmp_path: Path) -> None:
    curves = [
        [
            entry["loss"]
            for entry in train("keypoint", tmp_path / name, encoder, seed=seed)["history"]
        ]
        for name, seed in (("a", 1), ("b", 1), ("c", 2))
    ]
    assert curves[0] == curves[1]
    assert curves[0] != curves[2]


def test_half_precision_learns_too(encoder: Path, tmp_path: Path) -> None:
    single, half = (
        train("keypoint", tmp_path / name, encoder, precision=name)["history"][-1]["loss"]
        for name in ("32", "bf16")
    )
    assert half == pytest.approx(single, rel=0.1)
