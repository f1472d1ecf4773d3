"""How much memory a worker takes."""

import resource
from pathlib import Path

import pytest

from keypush.objects.catalogue import catalogue_names
from keypush.rollout.job import Job
from keypush.rollout.parallel import run_job
from keypush.scenario import Scenario


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_worker_of_all_objects_stays_below_a_gigabyte(tmp_path: Path) -> None:
    """The largest of all child processes that this process has had."""
    job = Job(scenario=Scenario(policy="expert"), objects=tuple(catalogue_names()), episodes=3)
    run_job(job, tmp_path, workers=1)
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6 < 1.0
