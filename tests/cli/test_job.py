"""What a job says of itself, so that nothing is mixed that differs."""

import shutil
from pathlib import Path

import pytest

from keypush.cli.collect import Collect
from keypush.cli.parallel_options import make_job
from keypush.objects.library import object_folder, user_objects_dir
from keypush.scenario import Scenario


def test_a_user_object_of_the_same_name_is_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    told = []
    for source in ("can", "mug", "can"):
        shutil.rmtree(user_objects_dir() / "mine", ignore_errors=True)
        shutil.copytree(object_folder(source), user_objects_dir() / "mine")
        options = Collect(out=tmp_path, objects="plate,mine")
        job = make_job(Scenario(policy="expert"), options, option="episodes", episodes=1)
        told.append(job.provenance["user_objects_sha256"])
    assert told[0] == told[2] != told[1]


def test_built_in_objects_are_known_by_the_version(tmp_path: Path) -> None:
    options = Collect(out=tmp_path, objects="plate")
    job = make_job(Scenario(policy="expert"), options, option="episodes", episodes=1)
    assert list(job.provenance) == ["keypush"]
