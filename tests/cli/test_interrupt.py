"""Ctrl-C: no traceback, no orphans, and the same files in the end."""

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from keypush.cli.main import main
from tests.cli.command import KEYPUSH

ARGUMENTS = (
    "collect", "--objects", "plate", "--episodes-per-object", "45", "--workers", "2",
    "--set", "episode.max_steps=5", "--out",
)  # fmt: skip


def _processes_of_group(group: int) -> Iterator[int]:
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _parent, owner = stat.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue  # It ended while we looked.
        if int(owner) == group and state != "Z":
            yield int(stat.parent.name)


def _files(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


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
    assert list(_processes_of_group(process.pid)) == []
    finished = list(stopped.glob("collecting/episodes/*.parquet"))
    assert 1 <= len(finished) < 5
    assert list(stopped.rglob("*.partial")) == []

    capsys.readouterr()
    left = 45 - len(pq.read_table(stopped / "collecting" / "episodes"))
    for folder in (stopped, whole):
        assert main([*ARGUMENTS, str(folder)]) == 0
    assert _files(stopped) == _files(whole)
    assert f"{left} of 45 episodes to run" in capsys.readouterr().err
