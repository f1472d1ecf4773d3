import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from safetensors.numpy import load_file

from tests.cli.command import KEYPUSH

OPTIONS = [
    "--objects", "mug,book", "--measure-on", "can", "--epochs", "4", "--samples-per-epoch", "256",
    "--batch", "64", "--clouds-per-object", "8", "--validation-samples", "64",
    "--encoder.layers", "3", "--encoder.patch-size", "16",
]  # fmt: skip


def _start(out: Path) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [KEYPUSH, "pretrain", *OPTIONS, "--out", str(out)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip


def _finish(out: Path) -> str:
    process = _start(out)
    told, complaints = process.communicate(timeout=600)
    assert (process.returncode, complaints) == (0, "")
    return told


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_killed_pretraining_ends_in_the_same_weights(tmp_path: Path) -> None:
    once, twice = tmp_path / "once", tmp_path / "twice"
    told = _finish(once)
    assert "can, task scenes: average precision" in told
    process = _start(twice)
    while not (twice / "checkpoints" / "last.ckpt").exists():
        assert process.poll() is None
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    assert not (twice / "contact.safetensors").exists()
    assert _finish(twice) == told.replace("/once/", "/twice/")
    weights, others = (
        load_file(once / "contact.safetensors"),
        load_file(twice / "contact.safetensors"),
    )
    assert weights.keys() == others.keys()
    assert all((weights[name] == others[name]).all() for name in weights)
    sizes = json.loads((twice / "contact.json").read_text())["network"]
    assert (sizes["patch_size"], sizes["layers"]) == (16, 3)
