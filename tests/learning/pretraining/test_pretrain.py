import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest
import torch
from safetensors.torch import load_file

from keypush.errors import UserError
from keypush.learning.checkpoint import load_network
from keypush.learning.lightning_run import CHECKPOINTS, LAST
from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.contact_objects import contact_objects
from keypush.learning.pretraining.contact_scenes import ContactBatches
from keypush.learning.pretraining.module import ContactModule
from keypush.learning.pretraining.scores import score
from keypush.learning.pretraining.train import WEIGHTS, pretrain
from keypush.networks.config import EncoderConfig
from keypush.networks.contact_network import ContactNetwork

QUICK = PretrainConfig(
    epochs=2, samples_per_epoch=32, batch=16, clouds_per_object=2, validation_samples=32,
    precision="32", held_out_objects=["mug"], encoder=EncoderConfig(layers=1),
)  # fmt: skip
OBJECTS = "mug,book"


def _without_speed(card: dict[str, Any]) -> dict[str, Any]:
    del card["samples_per_second"]
    for entry in card["metrics"]["history"]:
        del entry["samples_per_second"]
    return card


@pytest.mark.parametrize("precision", ["32", "bf16"])
def test_resumed_run_ends_with_the_same_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, precision: str
) -> None:
    config = dataclasses.replace(QUICK, precision=precision)
    pretrain(OBJECTS, [], tmp_path / "once", config)
    batches = ContactModule.batches

    def interrupted(module: ContactModule, epoch: int) -> ContactBatches:
        if epoch == 1:
            raise KeyboardInterrupt
        return batches(module, epoch)

    monkeypatch.setattr(ContactModule, "batches", interrupted)
    with pytest.raises(KeyboardInterrupt):
        pretrain(OBJECTS, [], tmp_path / "twice", config)
    monkeypatch.undo()
    assert not (tmp_path / "twice" / WEIGHTS).exists()
    pretrain(OBJECTS, [], tmp_path / "twice", config)
    once, twice = load_file(tmp_path / "once" / WEIGHTS), load_file(tmp_path / "twice" / WEIGHTS)
    for name, weights in once.items():
        torch.testing.assert_close(weights, twice[name], atol=0, rtol=0)
    cards = [
        _without_speed(json.loads((tmp_path / run / "contact.json").read_text()))
        for run in ("once", "twice")
    ]
    assert cards[0] == cards[1]


def test_card_tells_what_the_weights_are(tmp_path: Path) -> None:
    scores = pretrain(OBJECTS, ["can", "candle"], tmp_path, QUICK)
    assert set(scores) == {"train", "mug", "can", "candle"}
    for kinds in scores.values():
        for found in (kinds["random_scenes"], kinds["task_scenes"]):
            assert found["scenes"] == 32
            assert 0 <= found["average_precision"] <= 1
            assert sum(row["patches"] for row in found["reliability"]) == 32 * 16
    card = json.loads((tmp_path / "contact.json").read_text())
    assert card["kind"] == "contact"
    assert card["data"] == {"objects": ["book"], "seeds": [0], "samples": 64}
    assert card["training"]["held_out_objects"] == ["mug"]
    assert card["metrics"]["mug"] == scores["mug"]
    assert card["git_revision"]
    assert card["samples_per_second"] > 0
    assert load_network(tmp_path / WEIGHTS, ContactNetwork).config == QUICK.encoder


def test_few_scenes_are_learnt_by_heart() -> None:
    config = dataclasses.replace(QUICK, encoder=EncoderConfig(layers=1, dropout=0.0), batch=24)
    (batch,) = ContactBatches(contact_objects(["mug", "book"]), config, (0, "test"), 24)
    *scene, label = batch
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        network = ContactNetwork(config.encoder)
    optimiser = torch.optim.AdamW(network.parameters(), lr=2e-3)
    for _ in range(100):
        loss = torch.nn.functional.binary_cross_entropy_with_logits(network(*scene), label)
        optimiser.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]  # torch's own
        optimiser.step()
    assert loss.item() < 0.03


def test_order_of_points_does_not_matter() -> None:
    (batch,) = ContactBatches(contact_objects(["mug"]), QUICK, (0, "test"), 16)
    cloud, centres, members, hand, _ = batch
    order = torch.randperm(512, generator=torch.Generator().manual_seed(0))
    place = order.argsort()
    network = ContactNetwork(EncoderConfig()).eval()
    with torch.inference_mode():
        one = network(cloud, centres, members, hand)
        other = network(cloud[:, order], place[centres], place[members], hand)
    torch.testing.assert_close(one, other, atol=0, rtol=0)


def test_scores_of_a_known_case() -> None:
    truth = torch.tensor([[1.0, 1.0, 0.0, 0.0]])
    sure = score(torch.tensor([[20.0, 20.0, -20.0, -20.0]]), truth)
    assert sure["average_precision"] == sure["f1"] == pytest.approx(1.0)
    assert sure["calibration_error"] == pytest.approx(0.0, abs=1e-6)
    unsure = score(torch.full((1, 4), 2.0), truth)
    assert unsure["average_precision"] == pytest.approx(0.5)
    assert unsure["f1"] == pytest.approx(2 / 3)
    predicted = float(torch.tensor(2.0).sigmoid())
    assert unsure["calibration_error"] == pytest.approx(predicted - 0.5, abs=1e-6)
    (row,) = unsure["reliability"]
    assert row == {
        "from": 0.8,
        "patches": 4,
        "predicted": pytest.approx(predicted),
        "observed": 0.5,
    }


@pytest.mark.parametrize(
    ("objects", "change", "message"),
    [
        ("unicorn", {}, "object 'unicorn' is not there; allowed"),
        ("", {}, "objects is '', which names none; allowed"),
        (OBJECTS, {"held_out_objects": ["can"]}, "held_out_objects has can; allowed: book, mug"),
        (OBJECTS, {"held_out_objects": ["mug", "book"]}, "held_out_objects has all of"),
        (OBJECTS, {"task_share": 1.5}, r"task_share is 1\.5; allowed: 0 to 1"),
        (OBJECTS, {"learning_rate": float("nan")}, "learning_rate is nan; allowed"),
        (OBJECTS, {"precision": "16"}, "precision is '16'; allowed: 32, bf16"),
        (OBJECTS, {"samples_per_epoch": 0}, "samples_per_epoch is 0; allowed: 1"),
        (OBJECTS, {"encoder": EncoderConfig(patch_size=12)}, r"encoder\.patch_size is 12; allowed"),
        (
            OBJECTS,
            {"encoder": EncoderConfig(layers=0)},
            r"encoder\.layers is 0; allowed: a whole number from 1 to 16",
        ),
    ],
)
def test_mistakes_are_named(
    tmp_path: Path, objects: str, change: dict[str, Any], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        pretrain(objects, [], tmp_path, dataclasses.replace(QUICK, **change))


def test_unknown_objects_to_measure_on_are_told_before_training(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="object 'unicorn' is not there"):
        pretrain(OBJECTS, ["unicorn"], tmp_path, QUICK)
    assert not (tmp_path / CHECKPOINTS).exists()


def test_a_list_with_the_name_of_what_is_trained_on_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        UserError, match=r"measure_on has train, but the scores .* of book; allowed"
    ):
        pretrain(OBJECTS, ["mug", "train"], tmp_path, QUICK)
    assert not (tmp_path / CHECKPOINTS).exists()
    once = dataclasses.replace(QUICK, epochs=1)
    assert pretrain(OBJECTS, ["mug"], tmp_path, once).keys() == {"train", "mug"}


def test_checkpoints_of_another_run_are_refused(tmp_path: Path) -> None:
    once = dataclasses.replace(QUICK, epochs=1)
    pretrain(OBJECTS, [], tmp_path, once)
    with pytest.raises(UserError, match=r"last\.ckpt: is from a run with other values of seed"):
        pretrain(OBJECTS, [], tmp_path, dataclasses.replace(once, seed=1))
    with pytest.raises(UserError, match=r"last\.ckpt: is from a run with other values of objects"):
        pretrain("mug,can", [], tmp_path, once)
    (tmp_path / CHECKPOINTS / LAST).write_bytes(b"damaged")
    with pytest.raises(UserError, match=r"last\.ckpt: is no checkpoint"):
        pretrain(OBJECTS, [], tmp_path, once)
