"""A disk that fills while episodes are collected: one line, and nothing collected is lost."""

import resource
import subprocess
import time
from pathlib import Path

import pytest

from keypush.cli.main import main
from tests.cli.command import KEYPUSH
from tests.rollout.short_scenarios import finished_episodes

ARGUMENTS = (
    "collect", "--objects", "plate", "--episodes-per-object", "45", "--workers", "1",
    "--set", "episode.max_steps=5", "--out",
)  # fmt: skip


@pytest.mark.slow
def test_finished_blocks_outlive_a_full_disk(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    process = subprocess.Popen([KEYPUSH, *ARGUMENTS, tmp_path], stderr=subprocess.PIPE, text=True)
    while not list(tmp_path.glob("collecting/episodes/*.parquet")):
        assert process.poll() is None
        time.sleep(0.01)
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (1000, 1000))
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    last = errors.splitlines()[-1]
    assert "cannot be written: File too large" in last
    assert "finished episodes are kept" in last
    assert "Traceback" not in errors

    left = 45 - finished_episodes(tmp_path / "collecting")
    assert 0 < left < 45
    assert main([*ARGUMENTS, str(tmp_path)]) == 0
    assert f"{left} of 45 episodes to run" in capsys.readouterr().err
