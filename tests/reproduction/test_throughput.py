"""Episodes per second count what was really finished and really spent."""

from dataclasses import replace
from pathlib import Path

import pytest

from keypush.errors import UserError
from keypush.reproduction.part import Part
from keypush.reproduction.throughput import Session, rate, read_sessions, timed
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.job import Job
from keypush.rollout.shard import make_shard
from keypush.rollout.store import EpisodeStore, finished_episodes
from tests.rollout.short_scenarios import short_scenario

JOB = Job(scenario=short_scenario(), objects=("plate",), episodes=25)


def _finish(out: Path, *firsts: int) -> None:
    for kind in ("rows", "episodes"):
        (out / kind).mkdir(parents=True, exist_ok=True)
        for first in firsts:
            (out / kind / f"plate-{first:06d}.parquet").touch()


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


def test_episodes_of_a_block_that_is_not_finished_count_for_who_ran_them(tmp_path: Path) -> None:
    job = replace(JOB, episodes=10)
    part = Part(job=job, folder=tmp_path, name="part")
    runner, store = EpisodeRunner(job.scenario), EpisodeStore(tmp_path)
    for finished in (range(8), range(8, 10)):
        (missing,) = store.open(job).missing
        with timed(job, tmp_path, workers=1):
            for episode in finished:
                store.write(missing.one(episode), make_shard(runner.run(episode)))
        assert part.left == job.total - finished[-1] - 1
    assert [session.episodes for session in read_sessions(tmp_path)] == [8, 2]


def test_episodes_that_lie_in_a_block_and_beside_it_count_once(tmp_path: Path) -> None:
    _finish(tmp_path, 0)
    _finish(tmp_path / "unfinished", 0, 9, 13)
    assert finished_episodes(JOB, tmp_path) == 11


def test_the_rate_is_over_all_sessions() -> None:
    first = Session(episodes=30, seconds=10.0, workers=2)
    assert rate([first, replace(first, episodes=10, seconds=30.0)]) == 1.0
    assert rate([]) is None


def test_a_damaged_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "timing.json").write_text('{"sessions": [{"episodes": 1}]}')
    with pytest.raises(UserError, match=r"timing\.json: cannot be read"):
        read_sessions(tmp_path)
