"""The parallel runner: same bytes for any number of processes, resuming, failures."""

import multiprocessing
import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import yaml

from keypush.errors import UserError
from keypush.rollout.job import EPISODES_PER_BLOCK, Job
from keypush.rollout.parallel import run_job
from keypush.rollout.store import EpisodeStore
from keypush.rollout.worker import MakeRunner
from tests.rollout.short_scenarios import (
    DyingLaterRunner,
    DyingOnceRunner,
    DyingRunner,
    InterruptingRunner,
    MistakenRunner,
    RaisingRunner,
    bytes_of,
    short_scenario,
)


def _job(episodes: int = 11) -> Job:
    return Job(scenario=short_scenario(), objects=("plate", "can"), episodes=episodes)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("one_process")
    run_job(_job(), folder, workers=1)
    return folder


def test_every_episode_is_there_once(finished: Path) -> None:
    for kind in ("rows", "episodes"):
        files = sorted(path.name for path in (finished / kind).iterdir())
        assert files == [f"{o}-{n}.parquet" for o in ("can", "plate") for n in ("000000", "000010")]
    episodes = pq.read_table(finished / "episodes").to_pylist()
    assert sorted((e["object"], e["episode"]) for e in episodes) == sorted(
        (name, i) for name in ("can", "plate") for i in range(11)
    )
    rows = pq.read_table(finished / "rows").to_pydict()
    steps = {(e["object"], e["episode"]): e["steps"] for e in episodes}
    for key, count in steps.items():
        mine = [
            step
            for name, episode, step in zip(
                rows["object"], rows["episode"], rows["step"], strict=True
            )
            if (name, episode) == key
        ]
        assert mine == list(range(len(mine)))
        assert len(mine) >= count


def test_two_workers_write_the_same_bytes_as_one(finished: Path, tmp_path: Path) -> None:
    run_job(_job(), tmp_path, workers=2)
    assert bytes_of(tmp_path) == bytes_of(finished)


def test_resuming_runs_only_what_is_missing(finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished, tmp_path, dirs_exist_ok=True)
    kept = tmp_path / "episodes" / "plate-000000.parquet"
    before = kept.stat().st_mtime_ns
    (tmp_path / "episodes" / "can-000010.parquet").unlink()
    (tmp_path / "rows" / ".can-000010.parquet.1.partial").write_bytes(b"half a file")
    run_job(_job(), tmp_path, workers=1)
    assert bytes_of(tmp_path) == bytes_of(finished)
    assert kept.stat().st_mtime_ns == before


def test_another_job_is_refused_by_the_field_that_differs(finished: Path) -> None:
    with pytest.raises(UserError, match=r"job\.yaml: episodes is 11 there and 12 now"):
        run_job(_job(12), finished, workers=1)
    other = _job()
    other.scenario.noise.cloud_deviation = 0.25
    with pytest.raises(UserError, match=r"scenario\.yaml: noise\.cloud_deviation is 0\.005"):
        run_job(other, finished, workers=1)


@pytest.mark.parametrize(
    ("make_runner", "error", "text"),
    [
        (RaisingRunner, RuntimeError, r"block plate-000000 .*\n.*ZeroDivisionError"),
        (DyingRunner, UserError, r"block plate-000000 .*SIGKILL.*, for the second time"),
        (MistakenRunner, UserError, "^weights of plate: none for episode 0$"),
    ],
)
def test_a_failure_in_a_worker_reaches_the_caller(
    make_runner: MakeRunner, error: type[Exception], text: str, tmp_path: Path
) -> None:
    job = Job(scenario=short_scenario(), objects=("plate",), episodes=1)
    with pytest.raises(error, match=f"(?s){text}"):
        run_job(job, tmp_path, workers=2, make_runner=make_runner)
    assert multiprocessing.active_children() == []
    assert list((tmp_path / "episodes").iterdir()) == []


def test_a_killed_worker_is_replaced_and_its_block_run_again(
    finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_job(_job(), tmp_path, workers=2, make_runner=DyingOnceRunner.beside(tmp_path))
    assert bytes_of(tmp_path) == bytes_of(finished)
    lines = [line for line in capsys.readouterr().err.splitlines() if "SIGKILL" in line]
    assert len(lines) == 1
    assert lines[0].startswith("keypush: block ")


def test_a_killed_worker_loses_the_episode_under_way_alone(
    finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_job(_job(), tmp_path, workers=1, make_runner=DyingLaterRunner.beside(tmp_path))
    assert bytes_of(tmp_path) == bytes_of(finished)
    assert "block plate-000003 (episodes 3 to 9 of plate)" in capsys.readouterr().err


def test_a_stop_in_a_block_loses_no_finished_episode(finished: Path, tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        run_job(_job(), tmp_path, workers=1, make_runner=InterruptingRunner.of(tmp_path))
    kept = sorted(path.name for path in (tmp_path / "unfinished" / "episodes").iterdir())
    assert kept == [f"plate-{n:06d}.parquet" for n in range(4)]
    store = EpisodeStore(tmp_path)
    found = store.open(_job())
    assert found.episodes == 4
    assert [(b.object, b.first, b.count) for b in found.missing][:2] == [
        ("plate", 4, 6),
        ("plate", 10, 1),
    ]
    run_job(_job(), tmp_path, workers=2)
    assert bytes_of(tmp_path) == bytes_of(finished)


def test_a_stop_between_the_last_episode_and_its_block_costs_nothing(tmp_path: Path) -> None:
    job = Job(scenario=short_scenario(), objects=("plate",), episodes=4)
    with pytest.raises(KeyboardInterrupt):
        run_job(_job(), tmp_path, workers=1, make_runner=InterruptingRunner.of(tmp_path))
    (tmp_path / "job.yaml").write_text(yaml.safe_dump(job.describe()))
    found = EpisodeStore(tmp_path).open(job)
    assert (found.episodes, found.missing) == (4, [])
    assert not (tmp_path / "unfinished").exists()
    run_job(job, tmp_path, workers=1)
    assert len(EpisodeStore(tmp_path).read_summaries()) == 4


@pytest.mark.parametrize("kind", ["rows", "episodes"])
def test_a_damaged_unfinished_episode_is_named(kind: str, tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        run_job(_job(), tmp_path, workers=1, make_runner=InterruptingRunner.of(tmp_path))
    path = tmp_path / "unfinished" / kind / "plate-000002.parquet"
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(
        UserError, match=rf"unfinished/{kind}/plate-000002\.parquet: cannot be read"
    ):
        run_job(_job(), tmp_path, workers=1)
    path.rename(path.with_name("can-000099.parquet"))
    with pytest.raises(UserError, match=r"can-000099\.parquet: is no part of this job"):
        run_job(_job(), tmp_path, workers=1)


def test_blocks_cover_every_episode_without_overlap() -> None:
    job = _job(2 * EPISODES_PER_BLOCK + 3)
    covered = [(b.object, b.first + i) for b in job.blocks() for i in range(b.count)]
    assert covered == [(name, i) for name in job.objects for i in range(job.episodes)]
    assert len(covered) == job.total
