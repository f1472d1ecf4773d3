"""A data set of tiny episodes: complete, resumed, refused."""

import resource
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from keypush.errors import UserError
from keypush.rollout.collection import SHARDS, collect_dataset
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.job import Job
from keypush.rollout.parallel import run_job
from keypush.scenario import parse_scenario
from tests.rollout.short_scenarios import bytes_of, short_scenario


def _job(episodes: int = 2) -> Job:
    return Job(scenario=short_scenario(), objects=("plate",), episodes=episodes)


@contextmanager
def _small_files(most: int) -> Iterator[None]:
    """No file may grow beyond some bytes, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture(scope="module")
def shards(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shards")
    run_job(_job(), folder, workers=1)
    return folder


@pytest.fixture(scope="module")
def complete(shards: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("complete")
    shutil.copytree(shards, folder / SHARDS)
    assert collect_dataset(_job(), folder, workers=1) is not None
    return folder


def test_shards_give_way_to_the_data_set(complete: Path) -> None:
    assert sorted(path.name for path in complete.iterdir()) == ["data", "meta"]
    assert {"info.json", "job.yaml", "scenario.yaml"} <= {p.name for p in complete.glob("meta/*")}


def test_a_complete_data_set_is_left_alone(complete: Path) -> None:
    before = bytes_of(complete)
    (complete / SHARDS / "rows").mkdir(parents=True)  # A run was killed while it removed them.
    assert collect_dataset(_job(), complete) is None
    assert bytes_of(complete) == before
    assert not (complete / SHARDS).exists()


def test_a_run_that_was_killed_while_it_assembled_goes_on(
    shards: Path, complete: Path, tmp_path: Path
) -> None:
    shutil.copytree(complete, tmp_path, dirs_exist_ok=True)
    shutil.copytree(shards, tmp_path / SHARDS)
    (tmp_path / "meta" / "info.json").unlink()
    shutil.rmtree(tmp_path / "data")
    assert collect_dataset(_job(), tmp_path, workers=1) is not None
    assert bytes_of(tmp_path) == bytes_of(complete)


def test_a_complete_data_set_of_another_job_is_refused(complete: Path) -> None:
    with pytest.raises(UserError, match=r"meta/job\.yaml: episodes is 2 there and 3 now"):
        collect_dataset(_job(3), complete)


def test_a_folder_of_another_version_is_refused(tmp_path: Path) -> None:
    jobs = [
        Job(scenario=short_scenario(), objects=("plate",), episodes=1, provenance={"keypush": v})
        for v in ("0.1.0", "0.2.0")
    ]
    (tmp_path / SHARDS).mkdir()
    run_job(jobs[0], tmp_path / SHARDS, workers=1)
    with pytest.raises(UserError, match=r"job\.yaml: keypush is '0\.1\.0' there and '0\.2\.0'"):
        collect_dataset(jobs[1], tmp_path)


def test_a_folder_of_evaluations_is_refused(shards: Path) -> None:
    with pytest.raises(UserError, match=r"job\.yaml"):
        collect_dataset(_job(), shards)


@pytest.mark.parametrize("name", ["data", "meta"])
def test_what_would_be_in_the_way_is_named_before_anything_runs(name: str, tmp_path: Path) -> None:
    (tmp_path / name).mkdir()
    with pytest.raises(UserError, match=r"meta/scenario\.yaml: cannot be read"):
        collect_dataset(_job(), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_an_object_without_a_start_is_named_before_anything_runs(tmp_path: Path) -> None:
    text = "{policy: expert, episode: {goal: [0.0, 0.0], goal_min_distance: 0.5}}"
    job = Job(scenario=parse_scenario(text), objects=("plate",), episodes=1)
    with pytest.raises(UserError, match="goal_min_distance"):
        collect_dataset(job, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_period_that_no_data_set_can_have_is_named_before_anything_runs(tmp_path: Path) -> None:
    scenario = parse_scenario("{policy: expert, episode: {policy_period: 0.15}}")
    with pytest.raises(UserError, match=r"policy_period is 0\.15; allowed in a data set: 1 s div"):
        collect_dataset(Job(scenario=scenario, objects=("plate",), episodes=1), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_one_run_at_a_time(tmp_path: Path) -> None:
    with hold_folder(tmp_path), pytest.raises(UserError, match="another run is at work"):
        collect_dataset(_job(), tmp_path)


def test_a_full_disk_keeps_what_was_collected(shards: Path, complete: Path, tmp_path: Path) -> None:
    shutil.copytree(shards, tmp_path / SHARDS)
    (tmp_path / SHARDS / "rows" / "plate-000000.parquet").unlink()
    with (
        _small_files(8000),
        pytest.raises(UserError, match=r"plate-000000\.parquet: cannot be written: File too large"),
    ):
        collect_dataset(_job(), tmp_path, workers=1)
    assert list(tmp_path.rglob("*.partial")) == []
    assert collect_dataset(_job(), tmp_path, workers=1) is not None
    assert bytes_of(tmp_path) == bytes_of(complete)


def test_a_disk_that_fills_in_the_end_keeps_the_episodes(
    shards: Path, complete: Path, tmp_path: Path
) -> None:
    shutil.copytree(shards, tmp_path / SHARDS)
    with (
        _small_files(8000),
        pytest.raises(UserError, match=f"all episodes are kept in {tmp_path / SHARDS}"),
    ):
        collect_dataset(_job(), tmp_path, workers=1)
    assert bytes_of(tmp_path / SHARDS) == bytes_of(shards)
    assert collect_dataset(_job(), tmp_path, workers=1) is not None
    assert bytes_of(tmp_path) == bytes_of(complete)
