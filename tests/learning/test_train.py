import dataclasses
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from safetensors.torch import load_file

from keypush.errors import UserError
from keypush.learning.checkpoint import load_network
from keypush.learning.config import TrainingConfig
from keypush.learning.cosine_module import rate
from keypush.learning.lightning_run import CHECKPOINTS, LAST, read_checkpoint
from keypush.learning.surface_module import SurfaceModule
from keypush.learning.train import WEIGHTS, train
from keypush.networks.config import SurfaceConfig
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork
from tests.learning.scenes import SMALL
from tests.learning.synthetic import STEPS, write_data

QUICK = TrainingConfig(
    label="analytic", epochs=2, batch=16, cloud_points=64, clouds_per_object=2, network=SMALL
)


@pytest.fixture(scope="module")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    objects = [("bottle", 1.0), ("can", 1.0), ("l_block", 1.25)]
    return write_data(tmp_path_factory.mktemp("data"), objects, episodes=20)


def test_resumed_run_ends_with_the_same_bits(
    data_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    train(data_dir, tmp_path / "once", QUICK)
    original = SurfaceModule.batches

    def interrupted(self, epoch):  # type: ignore[no-untyped-def]  # stands in for batches
        if epoch == 1:
            raise KeyboardInterrupt
        return original(self, epoch)

    monkeypatch.setattr(SurfaceModule, "batches", interrupted)
    with pytest.raises(KeyboardInterrupt):
        train(data_dir, tmp_path / "twice", QUICK)
    monkeypatch.undo()
    assert not (tmp_path / "twice" / WEIGHTS).exists()
    train(data_dir, tmp_path / "twice", QUICK)
    once, twice = load_file(tmp_path / "once" / WEIGHTS), load_file(tmp_path / "twice" / WEIGHTS)
    for name, weights in once.items():
        torch.testing.assert_close(weights, twice[name], atol=0, rtol=0)
    descriptions = [(tmp_path / d / WEIGHTS).with_suffix(".json") for d in ("once", "twice")]
    assert descriptions[0].read_text() == descriptions[1].read_text()


def test_training_leaves_torch_as_it_was(data_dir: Path, tmp_path: Path) -> None:
    state, threads = torch.get_rng_state(), torch.get_num_threads()
    train(data_dir, tmp_path, dataclasses.replace(QUICK, epochs=1))
    assert torch.equal(torch.get_rng_state(), state)
    assert torch.get_num_threads() == threads


def test_other_seed_gives_other_weights(data_dir: Path, tmp_path: Path) -> None:
    one = dataclasses.replace(QUICK, epochs=1)
    train(data_dir, tmp_path / "a", one)
    train(data_dir, tmp_path / "b", dataclasses.replace(one, seed=1))
    a, b = load_file(tmp_path / "a" / WEIGHTS), load_file(tmp_path / "b" / WEIGHTS)
    assert not torch.equal(a["score.weight"], b["score.weight"])


def test_result_loads_and_says_where_it_came_from(data_dir: Path, tmp_path: Path) -> None:
    config = dataclasses.replace(QUICK, epochs=1, held_out_objects=["can"], label="measured")
    metrics = train(data_dir, tmp_path, config)
    assert metrics["held_out_objects"]["can"]["rows"] == 20 * STEPS
    description = json.loads((tmp_path / WEIGHTS).with_suffix(".json").read_text())
    assert description["metrics"] == metrics
    assert description["training"]["label"] == "measured"
    assert description["data"]["seeds"] == [0]
    assert load_network(tmp_path / WEIGHTS, SurfaceKeypointNetwork).config == SMALL


def test_small_network_learns_where_to_push(data_dir: Path, tmp_path: Path) -> None:
    network = SurfaceConfig(
        patches=4, patch_size=16, width=32, patch_width=32, layers=1, point_width=32
    )
    config = dataclasses.replace(
        QUICK, epochs=20, cloud_points=128, learning_rate=5e-3, held_out_objects=["can"],
        network=network,
    )  # fmt: skip
    metrics = train(data_dir, tmp_path, config)
    for errors in (metrics["validation"], metrics["held_out_objects"]["can"]):
        # The best constant in the goal frame is off by about 1.5 cm, an untrained network by 4 cm.
        assert errors["error_mean"] < 0.012
        assert errors["error_lateral_mean"] < 0.006


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"epochs": 0}, "epochs is 0; allowed: 1 to"),
        ({"learning_rate": float("nan")}, "learning_rate is nan; allowed"),
        ({"accelerator": "abacus"}, "accelerator is 'abacus'; allowed: cpu, gpu, auto"),
        ({"label": "guessed"}, "label is 'guessed'; allowed: measured, analytic"),
        ({"held_out_objects": ["mug"]}, "held_out_objects has mug; allowed: bottle, can, l_block"),
        ({"held_out_objects": ["bottle", "can", "l_block"]}, "0 episodes have labelled rows"),
        ({"cloud_points": 4097}, "cloud_points is 4097; allowed: 16 to 4096"),
        ({"network": SurfaceConfig(heads=3)}, r"network\.heads is 3; allowed: a divisor of 128"),
        ({"network": SurfaceConfig(query_heads=0)}, r"query_heads is 0; allowed: a divisor of 128"),
        ({"network": SurfaceConfig(layers=0)}, r"network\.layers is 0; allowed: .* from 1 to 16"),
        (
            {"network": SurfaceConfig(width=-128)},
            r"network\.width is -128; allowed: a whole number",
        ),
        ({"network": SurfaceConfig(patches=0)}, r"network\.patches is 0; allowed: a whole number"),
        ({"network": SurfaceConfig(patch_size=65)}, "cloud_points is 64; allowed: at least 65"),
    ],
)
def test_bad_configurations_are_named(
    data_dir: Path, tmp_path: Path, change: dict[str, object], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        train(data_dir, tmp_path, dataclasses.replace(QUICK, **change))  # type: ignore[arg-type]  # wrong on purpose


def test_checkpoint_of_another_run_is_refused(data_dir: Path, tmp_path: Path) -> None:
    train(data_dir, tmp_path, dataclasses.replace(QUICK, epochs=1))
    with pytest.raises(UserError, match=r"last\.ckpt: is from a run with other values of epochs;"):
        train(data_dir, tmp_path, QUICK)
    (tmp_path / CHECKPOINTS / LAST).write_bytes(b"damaged")
    with pytest.raises(UserError, match=r"last\.ckpt: is no checkpoint of `keypush`; delete it"):
        train(data_dir, tmp_path, QUICK)


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"keypush_run": 5},
        {"keypush_run": {1: 2, "a": 3}},
        {"keypush_history": 5},
        {"keypush_history": [5]},
        {"state_dict": None},
        [1],
    ],
)
def test_a_checkpoint_with_something_else_in_it_is_refused(tmp_path: Path, content: object) -> None:
    whole: dict[str, Any] = {"keypush_run": {}, "keypush_history": [], "state_dict": {}}
    path = tmp_path / LAST
    torch.save(whole, path)
    assert read_checkpoint(path, {}) == whole
    torch.save({**whole, **content} if isinstance(content, dict) and content else content, path)
    with pytest.raises(UserError, match=r"last\.ckpt: is no checkpoint of `keypush`; delete it"):
        read_checkpoint(path, {})


@pytest.mark.parametrize(
    "pickled",
    [
        b"\x80\x02X\x02\x00\x00\x00\xff\xfe.",  # a text that is no UTF-8
        b"\x80\x020.",  # takes from an empty stack
        b"\x80\x02K\x01}b.",  # gives a state to a number
    ],
)
def test_a_checkpoint_that_cannot_be_unpickled_is_refused(tmp_path: Path, pickled: bytes) -> None:
    path = tmp_path / LAST
    torch.save({}, path)
    with zipfile.ZipFile(path) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in content.items():
            archive.writestr(name, pickled if name.endswith("data.pkl") else data)
    with pytest.raises(UserError, match=r"last\.ckpt: is no checkpoint of `keypush`; delete it"):
        read_checkpoint(path, {})


def test_patience_ends_training_and_keeps_the_best_epoch(data_dir: Path, tmp_path: Path) -> None:
    config = dataclasses.replace(QUICK, epochs=30, learning_rate=0.1, patience=1)
    metrics = train(data_dir, tmp_path, config)
    errors = [entry["error_mean"] for entry in metrics["history"]]
    assert len(errors) < 30
    assert errors.index(min(errors)) == len(errors) - 2
    assert metrics["validation"]["error_mean"] == pytest.approx(min(errors), rel=1e-6)
    assert train(data_dir, tmp_path, config) == metrics  # there is nothing left to train


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a GPU")
def test_a_gpu_that_is_not_there_is_named(data_dir: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"accelerator is 'gpu' and devices is 1: .*; allowed: cpu"):
        train(data_dir, tmp_path, dataclasses.replace(QUICK, accelerator="gpu"))


def test_a_training_that_blows_up_says_so(
    data_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    original = SurfaceModule.loss

    def endless(self, batch):  # type: ignore[no-untyped-def]  # stands in for loss
        loss, rows = original(self, batch)
        return loss * torch.inf, rows

    monkeypatch.setattr(SurfaceModule, "loss", endless)
    with pytest.raises(UserError, match=r"loss is (nan|inf) .* after epoch 1; allowed: finite"):
        train(data_dir, tmp_path, QUICK)


def test_logs_are_kept_for_spreadsheets_and_tensorboard(data_dir: Path, tmp_path: Path) -> None:
    train(data_dir, tmp_path, QUICK)
    (start,) = (tmp_path / "logs").iterdir()
    assert "error_mean" in (start / "metrics.csv").read_text().splitlines()[0]
    assert list(start.glob("events.out.tfevents.*"))


def test_learning_rate_warms_up_and_falls_to_zero() -> None:
    values = [rate(done) for done in np.linspace(0, 1, 101)]
    assert 0 < values[0] < 0.1
    assert max(values) == pytest.approx(1.0)
    assert values[-1] == pytest.approx(0.0)
    peak = int(np.argmax(values))
    assert (np.diff(values[:peak]) > 0).all()
    assert (np.diff(values[peak:]) < 0).all()
