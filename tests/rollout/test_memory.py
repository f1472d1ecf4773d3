"""How much memory a worker takes."""

import resource
from pathlib import Path

import pytest

from keypush.objects.catalogue import catalogue_names
from keypush.rollout.job import Job
from keypush.rollout.parallel import run_job
from keypush.scenario import Scenario
from tests.rollout.new_process import in_new_process


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_worker_of_all_objects_stays_below_a_gigabyte(tmp_path: Path) -> None:
    assert in_new_process(_largest_worker, tmp_path) < 1.0


def _largest_worker(folder: Path) -> float:
    """Runs a job; returns the most memory that any child of this process has had, GB."""
    job = Job(scenario=Scenario(policy="expert"), objects=tuple(catalogue_names()), episodes=3)
    run_job(job, folder, workers=1)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
