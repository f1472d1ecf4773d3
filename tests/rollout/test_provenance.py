"""What decides episodes beside the scenario is told, and compared on other machines."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from keypush.errors import UserError
from keypush.objects.library import object_folder, user_objects_dir
from keypush.rollout.job import Job
from keypush.rollout.provenance import check_provenance, provenance
from keypush.scenario import Scenario, parse_scenario

OWN = Path(__file__).parents[2] / "scripts" / "own_policy.py"


def _job(scenario: Scenario, name: str = "can") -> Job:
    told = provenance(scenario, [name])
    return Job(scenario=scenario, objects=(name,), episodes=1, provenance=told)


@pytest.fixture
def own_policy_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Job:
    """Of a policy's file that is named from the working directory."""
    shutil.copy(OWN, tmp_path / "pol.py")
    monkeypatch.chdir(tmp_path)
    return _job(Scenario(policy="pol.py:RearPoint"))


def test_the_same_files_pass(own_policy_job: Job) -> None:
    check_provenance(own_policy_job)
    check_provenance(replace(own_policy_job, provenance={}))  # Of which nothing is known.


def test_another_file_of_the_policy_is_refused(own_policy_job: Job, tmp_path: Path) -> None:
    (tmp_path / "pol.py").write_text(OWN.read_text() + "\n# changed\n")
    with pytest.raises(UserError, match=r"^other than .* the file of the policy; allowed"):
        check_provenance(own_policy_job)
    (tmp_path / "pol.py").unlink()
    with pytest.raises(UserError, match=r"policy pol\.py:RearPoint: no file pol\.py"):
        check_provenance(own_policy_job)


def test_other_weights_are_refused() -> None:
    job = _job(parse_scenario("{policy: surface}"))
    other = replace(job, scenario=parse_scenario("{policy: surface_no_com}"))
    check_provenance(job)
    with pytest.raises(UserError, match=r"^other than .* the file of the weights; allowed"):
        check_provenance(other)


def test_other_objects_of_ones_own_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    mine = user_objects_dir() / "mine"
    shutil.copytree(object_folder("can"), mine)
    job = _job(parse_scenario("{policy: expert}"), "mine")
    check_provenance(job)
    (mine / "object.json").write_text((object_folder("mug") / "object.json").read_text())
    with pytest.raises(UserError, match=r"^other than .* files of your own objects; allowed"):
        check_provenance(job)
