"""Ctrl-C: no traceback, no orphans, and the same files in the end."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from keypush.cli.main import main
from tests.cli.command import KEYPUSH
from tests.cli.processes import wait_for_end
from tests.rollout.short_scenarios import bytes_of, finished_episodes

ARGUMENTS = (
    "collect", "--objects", "plate", "--episodes-per-object", "90", "--workers", "2",
    "--set", "episode.max_steps=5", "--out",
)  # fmt: skip


def test_an_interrupted_run_resumes_to_the_same_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stopped, whole = tmp_path / "stopped", tmp_path / "whole"
    process = subprocess.Popen(
        [KEYPUSH, *ARGUMENTS, stopped], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    while not list(stopped.glob("collecting/episodes/*.parquet")):
        assert process.poll() is None
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # What a terminal does: every process gets it.
    _, errors = process.communicate(timeout=60)

    assert process.returncode == 130
    assert "same command" in errors
    assert "Traceback" not in errors
    wait_for_end(process.pid, seconds=10)  # multiprocessing's own helper ends after the command
    finished = list(stopped.glob("collecting/episodes/*.parquet"))
    assert 1 <= len(finished) < 9
    assert list(stopped.rglob("*.partial")) == []

    capsys.readouterr()
    left = 90 - finished_episodes(stopped / "collecting")
    for folder in (stopped, whole):
        assert main([*ARGUMENTS, str(folder)]) == 0
    assert bytes_of(stopped) == bytes_of(whole)
    assert f"{left} of 90 episodes to run" in capsys.readouterr().err
