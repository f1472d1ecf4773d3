"""A training on a shared cache is the training that `keypush train` makes alone."""

import pickle
from dataclasses import replace
from pathlib import Path

import pytest

from keypush.learning.ablation.heads import KIND, HeadTask, train_setting
from keypush.learning.ablation.results import read_training
from keypush.learning.ablation.settings import SETTINGS, SHAPES
from keypush.learning.checkpoint import load_network
from keypush.learning.imitation.module import ImitationModule
from keypush.learning.imitation.token_cache import cache_tokens
from keypush.learning.imitation.train import head_data, train_imitation
from keypush.learning.rows import read_rows
from keypush.networks.contact_network import ContactNetwork
from tests.learning.ablation.sample import short_config, write_small_data
from tests.learning.imitation.sample import write_encoder

CONFIG = short_config()


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, HeadTask]:
    """The data, and a task whose cache is there."""
    folder = tmp_path_factory.mktemp("ablation")
    data_dir = write_small_data(folder / "data")
    encoder = write_encoder(folder / "contact.safetensors")
    data = head_data(KIND, read_rows(data_dir), data_dir, CONFIG.rows)
    network = load_network(encoder, ContactNetwork)
    cache_tokens(folder / "cache", data.examples, network.encoder, CONFIG.rows, lambda _: None)
    task = HeadTask(
        setting=SETTINGS[0],
        seed=0,
        out_dir=folder / "out",
        encoder=encoder,
        cache=folder / "cache",
        config=CONFIG.of_head(SETTINGS[0], 0),
        data=pickle.dumps(data),
    )
    return data_dir, task


@pytest.mark.parametrize("setting", [s for s in SETTINGS if s.shape == SHAPES[0]])
def test_a_shared_cache_changes_no_bit(setting, prepared, tmp_path) -> None:  # type: ignore[no-untyped-def]  # fixtures
    data_dir, task = prepared
    config = CONFIG.of_head(setting, 0)
    training = train_setting(replace(task, setting=setting, out_dir=tmp_path, config=config))
    alone = train_imitation(
        KIND, data_dir, tmp_path / "alone", task.encoder, config, lambda _: None
    )
    assert [epoch.train_mse for epoch in training.epochs] == [e["loss"] for e in alone["history"]]
    assert [(epoch.held_out_error, epoch.held_out_mse) for epoch in training.epochs] == [
        (e["held_out_error_mean"], e["held_out_mse"]) for e in alone["history"]
    ]
    assert training.epochs[-1].validation_error == alone["validation"]["error_mean"]
    assert training.objects == {
        name: each["error_mean"] for name, each in alone["held_out_objects"].items()
    }
    each = alone["held_out_objects"].values()
    rows = [one["rows"] for one in each]
    mean = sum(one["error_mean"] * one["rows"] for one in each) / sum(rows)
    assert len(rows) == 4
    assert training.held_out_error == pytest.approx(mean, rel=1e-4)


def test_an_interrupted_training_ends_in_the_same_record(
    prepared: tuple[Path, HeadTask], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, stopped = (replace(prepared[1], out_dir=tmp_path / name) for name in ("a", "b"))
    train_setting(whole)
    original = ImitationModule.batches

    def interrupted(self, epoch):  # type: ignore[no-untyped-def]  # stands in for batches
        if epoch == 1:
            raise KeyboardInterrupt
        return original(self, epoch)

    monkeypatch.setattr(ImitationModule, "batches", interrupted)
    with pytest.raises(KeyboardInterrupt):
        train_setting(stopped)
    monkeypatch.undo()
    assert read_training(stopped.record) is None
    assert (stopped.folder / "checkpoints" / "last.ckpt").exists()
    assert train_setting(stopped) == read_training(whole.record)
    assert stopped.record.read_bytes() == whole.record.read_bytes()
    assert not (stopped.folder / "checkpoints").exists()


def test_seeds_differ_in_the_head_alone(prepared: tuple[Path, HeadTask], tmp_path: Path) -> None:
    task = replace(prepared[1], out_dir=tmp_path)
    other = replace(task, seed=1, config=CONFIG.of_head(task.setting, 1))
    first, second = train_setting(task), train_setting(other)
    assert first.epochs[0].train_mse != second.epochs[0].train_mse
    assert task.record != other.record
    assert [e.learning_rate for e in first.epochs] == [4e-3, 4e-3]
