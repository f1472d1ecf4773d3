"""Blocks on a real Ray cluster of two nodes: same bytes, failures named, the dead replaced."""

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import ray
from ray.cluster_utils import Cluster

from keypush.errors import UserError
from keypush.rollout.job import Job
from keypush.rollout.parallel import run_job
from keypush.rollout.provenance import provenance
from tests.rollout.short_scenarios import (
    DyingOnceRunner,
    DyingRunner,
    MistakenRunner,
    bytes_of,
    short_scenario,
)

pytestmark = pytest.mark.slow
OWN_POLICY = f"{Path(__file__).parents[2] / 'scripts' / 'own_policy.py'}:RearPoint"


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    two_nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    two_nodes.add_node(num_cpus=1)
    ray.init(address=two_nodes.address, log_to_driver=False)
    yield
    ray.shutdown()
    two_nodes.shutdown()  # type: ignore[no-untyped-call]  # Ray has types in part


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("alone")
    run_job(_job(), folder, workers=1)
    return folder


def _job() -> Job:
    return Job(scenario=short_scenario(), objects=("plate", "can"), episodes=11)


@pytest.mark.usefixtures("cluster")
def test_ray_writes_the_same_bytes(alone: Path, tmp_path: Path) -> None:
    run_job(_job(), tmp_path, engine="ray")
    assert bytes_of(tmp_path) == bytes_of(alone)


@pytest.mark.usefixtures("cluster")
def test_a_policy_of_ones_own_drives_there_too(tmp_path: Path) -> None:
    job = replace(_job(), scenario=replace(short_scenario(), policy=OWN_POLICY), episodes=2)
    ray_too, alone = tmp_path / "ray", tmp_path / "alone"
    for folder in (ray_too, alone):
        folder.mkdir()
    run_job(job, ray_too, engine="ray")
    run_job(job, alone, workers=1)
    assert bytes_of(ray_too) == bytes_of(alone)


@pytest.mark.usefixtures("cluster")
def test_files_are_found_from_where_the_command_is_given_and_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(OWN_POLICY.rpartition(":")[0], tmp_path / "pol.py")
    monkeypatch.chdir(tmp_path)
    scenario = replace(short_scenario(), policy="pol.py:RearPoint")
    told = provenance(scenario, ["can"])
    job = Job(scenario=scenario, objects=("can",), episodes=1, provenance=told)
    for name in ("same", "other"):
        (tmp_path / name).mkdir()
    run_job(job, tmp_path / "same", engine="ray")
    with (tmp_path / "pol.py").open("a") as file:
        file.write("# changed\n")
    with pytest.raises(UserError, match=r"^machine \S+: other than .*: the file of the policy; "):
        run_job(job, tmp_path / "other", engine="ray")


@pytest.mark.usefixtures("cluster")
def test_a_killed_worker_is_replaced(
    alone: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(alone, tmp_path, dirs_exist_ok=True)
    (tmp_path / "episodes" / "can-000010.parquet").unlink()
    run_job(_job(), tmp_path, engine="ray", make_runner=DyingOnceRunner.beside(tmp_path))
    assert bytes_of(tmp_path) == bytes_of(alone)
    assert "can-000010 (episodes 10 to 10 of can)" in capfd.readouterr().err


@pytest.mark.usefixtures("cluster")
def test_mistakes_and_deadly_blocks_are_one_line(tmp_path: Path) -> None:
    job = Job(scenario=short_scenario(), objects=("plate",), episodes=1)
    with pytest.raises(UserError, match=r"^weights of plate: none for episode 0$"):
        run_job(job, tmp_path, engine="ray", make_runner=MistakenRunner)
    with pytest.raises(UserError, match=r"block plate-000000 .* for the second time") as caught:
        run_job(job, tmp_path, engine="ray", make_runner=DyingRunner)
    assert "\n" not in str(caught.value)
