"""Episodes per second count what was really finished and really spent."""

from dataclasses import replace
from pathlib import Path

import pytest

from keypush.errors import UserError
from keypush.reproduction.throughput import Session, finished_episodes, rate, read_sessions, timed
from keypush.rollout.job import Job
from keypush.scenario import Scenario

JOB = Job(scenario=Scenario(), objects=("plate",), episodes=25)


def _finish(out: Path, *firsts: int) -> None:
    (out / "episodes").mkdir(exist_ok=True)
    for first in firsts:
        (out / "episodes" / f"plate-{first:06d}.parquet").touch()


def _finish_and_stop(out: Path) -> None:
    with timed(JOB, out, workers=2):
        _finish(out, 0)
        raise KeyboardInterrupt


def test_every_start_that_finished_something_is_a_session(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        _finish_and_stop(tmp_path)
    with timed(JOB, tmp_path, workers=1):
        _finish(tmp_path, 10, 20)
    with timed(JOB, tmp_path, workers=1):
        pass
    sessions = read_sessions(tmp_path)
    assert [(s.episodes, s.workers) for s in sessions] == [(10, 2), (15, 1)]
    assert all(session.seconds > 0 for session in sessions)
    assert finished_episodes(JOB, tmp_path) == 25


def test_the_rate_is_over_all_sessions() -> None:
    first = Session(episodes=30, seconds=10.0, workers=2)
    assert rate([first, replace(first, episodes=10, seconds=30.0)]) == 1.0
    assert rate([]) is None


def test_a_damaged_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "timing.json").write_text('{"sessions": [{"episodes": 1}]}')
    with pytest.raises(UserError, match=r"timing\.json: cannot be read"):
        read_sessions(tmp_path)
