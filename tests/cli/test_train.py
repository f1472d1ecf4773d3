"""`keypush train` as a user runs it."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file

from keypush.cli.main import main
from keypush.resources import weights_dir
from keypush.rollout.folder_lock import hold_folder
from tests.cli.command import KEYPUSH
from tests.learning.imitation.sample import SAMPLE, write_encoder


@pytest.fixture(scope="module")
def encoder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_encoder(tmp_path_factory.mktemp("encoder") / "contact.safetensors")


def _arguments(network: str, encoder: Path, out: Path) -> list[str]:
    return [
        "train", "--network", network, "--encoder", str(encoder), "--data", str(SAMPLE),
        "--out", str(out), "--head.rows-per-object", "100", "--head.batch", "64",
    ]  # fmt: skip


def test_a_head_is_trained_and_its_cache_told(
    encoder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = _arguments("behavior_cloning", encoder, tmp_path / "o")
    assert main([*arguments, "--head.epochs", "1", "--head.held-out-objects", "mug"]) == 0
    captured = capsys.readouterr()
    assert "GB on disk" in captured.err
    assert "translation_mm_mean" in captured.out
    assert f"written: {tmp_path / 'o' / 'behavior_cloning.safetensors'}" in captured.out
    card = json.loads((tmp_path / "o" / "behavior_cloning.json").read_text())
    assert card["training"]["batch"] == 64
    assert card["action_clips"] == {"translation": 0.06, "rotation": 0.1}


def test_heads_stand_on_the_encoder_that_ships(tmp_path: Path) -> None:
    small = ["--head.epochs", "1", "--head.rows-per-object", "16", "--head.clouds-per-object", "2",
             "--head.batch", "64"]  # fmt: skip
    out = tmp_path / "o"
    arguments = ["train", "--network", "keypoint", "--data", str(SAMPLE), "--out", str(out)]
    assert main([*arguments, *small]) == 0
    shipped = weights_dir() / "contact.safetensors"
    assert (out / "contact.safetensors").read_bytes() == shipped.read_bytes()


@pytest.mark.parametrize(
    "arguments", [["train", "--data", str(SAMPLE)], ["pretrain", "--objects", "can"]]
)
def test_one_training_at_a_time_is_at_work_in_a_folder(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with hold_folder(tmp_path):
        assert main([*arguments, "--out", str(tmp_path)]) == 2
    assert f"{tmp_path}: another run is at work in it" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--encoder", "x"], "surface_keypoint, which takes no --encoder; allowed: --surface"),
        (["--preset", "thesis"], "which takes no --preset; allowed: --surface"),
        (["--head.epochs", "1"], "which takes no --head; allowed: --surface"),
        (["--network", "keypoint", "--surface.epochs", "1"], "keypoint, which takes no --surface;"),
        (["--network", "keypoint", "--encoder", "none"], "weights 'none': no file"),
        (["--surface.batch", "0"], "batch is 0; allowed: 1 to 65536"),
    ],
)
def test_mistakes_are_named(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", "--data", str(SAMPLE), "--out", str(tmp_path / "o"), *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_run_that_was_stopped_ends_with_the_same_weights(
    how: signal.Signals, encoder: Path, tmp_path: Path
) -> None:
    arguments = _arguments("keypoint", encoder, tmp_path / "stopped")
    process = subprocess.Popen([KEYPUSH, *arguments], stderr=subprocess.PIPE, text=True)
    last = tmp_path / "stopped" / "checkpoints" / "last.ckpt"
    while not last.exists():
        assert process.poll() is None
        time.sleep(0.01)
    time.sleep(0.3)  # some epochs later
    os.kill(process.pid, how)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == (130 if how == signal.SIGINT else -how)
    assert "Traceback" not in errors
    assert not (tmp_path / "stopped" / "keypoint.safetensors").exists()
    for name in ("stopped", "whole"):
        assert main(_arguments("keypoint", encoder, tmp_path / name)) == 0
    stopped, whole = (
        load_file(tmp_path / name / "keypoint.safetensors") for name in ("stopped", "whole")
    )
    assert all(torch.equal(value, stopped[name]) for name, value in whole.items())
    cards = [json.loads((tmp_path / d / "keypoint.json").read_text()) for d in ("stopped", "whole")]
    assert cards[0]["metrics"] == cards[1]["metrics"]
