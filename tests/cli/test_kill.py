"""`kill -9` at any moment: the same command goes on, to the same files."""

import os
import random
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.cli.command import KEYPUSH
from tests.cli.processes import wait_for_end, workers_of_group
from tests.rollout.short_scenarios import bytes_of

ARGUMENTS = (
    "collect", "--objects", "plate", "--episodes-per-object", "25", "--workers", "2",
    "--set", "episode.max_steps=3", "--out",
)  # fmt: skip
KILLS = 20


def _start(folder: Path) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [KEYPUSH, *ARGUMENTS, folder],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def _collect(folder: Path) -> dict[str, bytes]:
    process = _start(folder)
    _, errors = process.communicate(timeout=100)
    assert process.returncode == 0, errors
    return bytes_of(folder)


def _run_and_kill(folder: Path, whom: str, seconds: float) -> None:
    """Kills a part of a run some time after its start."""
    process = _start(folder)
    time.sleep(seconds)
    if whom == "group":
        os.killpg(process.pid, signal.SIGKILL)
    elif whom == "parent":
        process.kill()
    else:
        for pid in workers_of_group(process.pid)[:1]:
            os.kill(pid, signal.SIGKILL)
    _, errors = process.communicate(timeout=100)
    wait_for_end(process.pid)
    assert "Traceback" not in errors
    # One worker less ends no run; a run may also have ended before its time.
    assert process.returncode in ((0,) if whom == "worker" else (0, -signal.SIGKILL)), errors


@pytest.mark.slow
@pytest.mark.timeout(2400)
def test_killed_runs_end_in_the_same_files(tmp_path: Path) -> None:
    began = time.monotonic()
    whole = _collect(tmp_path / "whole")
    duration = time.monotonic() - began
    assert "meta/info.json" in whole
    rng, folder = random.Random(0), tmp_path / "killed-0"
    for number in range(KILLS):
        whom = ("parent", "group", "worker")[number % 3]
        _run_and_kill(folder, whom, rng.uniform(0.1, 1.0) * duration)
        if (folder / "meta" / "info.json").exists():  # It came to its end: another one.
            assert _collect(folder) == whole
            folder = tmp_path / f"killed-{number + 1}"
    assert _collect(folder) == whole
