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


def _timing(episodes: str = "1", seconds: str = "1.5", workers: str = "2") -> str:
    """A file of two sessions, the second one with values as JSON."""
    first = '{"episodes": 3, "seconds": 1.0, "workers": 2}'
    second = f'{{"episodes": {episodes}, "seconds": {seconds}, "workers": {workers}}}'
    return f'{{"sessions": [{first}, {second}]}}'


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


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "cannot be read: "),
        ("[]", "has no list of sessions"),
        ('{"sessions": 3}', "has no list of sessions"),
        ('{"sessions": ["fast"]}', "session 1 is 'fast'"),
        ('{"sessions": [{"episodes": 1}]}', "session 1 is {'episodes': 1}"),
        (_timing(episodes='"a"'), "session 2: episodes is 'a'; allowed: a positive whole number"),
        (_timing(episodes="1.5"), "session 2: episodes is 1.5"),
        (_timing(episodes="-3"), "session 2: episodes is -3"),
        (_timing(seconds="null"), "session 2: seconds is None; allowed: a positive number"),
        (_timing(seconds="NaN"), "session 2: seconds is nan"),
        (_timing(seconds="Infinity"), "session 2: seconds is inf"),
        (_timing(seconds="0"), "session 2: seconds is 0"),
        (_timing(workers="[2]"), "session 2: workers is [2]"),
        (_timing(workers="true"), "session 2: workers is True"),
    ],
)
def test_a_damaged_file_is_named(content: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "timing.json").write_text(content)
    with pytest.raises(UserError) as caught:
        read_sessions(tmp_path)
    told = str(caught.value)
    assert told.startswith(f"{tmp_path / 'timing.json'}: {words}")
    assert "; allowed: " in told
    assert "\n" not in told


def test_whole_seconds_are_read(tmp_path: Path) -> None:
    (tmp_path / "timing.json").write_text(_timing(seconds="7"))
    assert rate(read_sessions(tmp_path)) == 0.5
