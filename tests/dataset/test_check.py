"""Each check passes on a good data set and fails on one that has what it looks for."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from keypush.dataset.check import EXPERT_OUTCOMES, check_dataset
from keypush.dataset.export import check_export
from keypush.dataset.job_file import USER_OBJECTS
from keypush.dataset.layout import JOB
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.learning.rows import read_rows
from keypush.objects.library import object_folder, user_objects_digest, user_objects_dir
from keypush.systems.episode_monitor import Outcome
from tests.dataset.edit import DATA, EPISODES, edit_json, edit_table, set_values
from tests.learning.synthetic import write_data


def test_good_data_sets_pass(synthetic: Path, real: Path) -> None:
    for folder in (synthetic, real):
        checks = check_dataset(open_dataset(folder))
        assert [name for name, check in checks.items() if not check.ok] == []
        assert {"episodes", "lengths", "numbering", "times", "labels"} <= checks.keys()


def test_outcomes_are_those_of_the_monitor() -> None:
    others = {Outcome.RUNNING, Outcome.POLICY_FAILED}
    assert [o.name.lower() for o in Outcome if o not in others] == list(EXPERT_OUTCOMES)


def _put(place: int, value: Any) -> Callable[[list[Any]], object]:
    return lambda values: values.__setitem__(place, value)


def _move(place: int, entry: int, by: float) -> Callable[[list[Any]], object]:
    return lambda values: values[place].__setitem__(entry, values[place][entry] + by)


def _shift_labels_and_contacts(folder: Path) -> None:
    edit_table(folder / DATA, lambda t: set_values(t, "keypoint", _move(7, 2, 0.2)))
    edit_table(folder / DATA, lambda t: set_values(t, "contact.measured", _move(7, 2, 0.2)))


@pytest.mark.parametrize(
    ("file", "column", "change", "check"),
    [
        (EPISODES, "object", _put(4, "can"), "episodes"),
        (EPISODES, "episode", _put(4, 2), "episodes"),
        (EPISODES, "episode_index", _put(4, 5), "episodes"),
        (EPISODES, "seed", _put(4, 1), "told"),
        (EPISODES, "outcome", _put(4, "flew away"), "told"),
        (EPISODES, "outcome", _put(4, "toppled"), "told"),
        (EPISODES, "success", _put(4, False), "told"),
        (EPISODES, "length", _put(4, 4), "lengths"),
        (EPISODES, "dataset_from_index", _put(4, 19), "lengths"),
        (EPISODES, "dataset_to_index", _put(8, 44), "lengths"),
        (EPISODES, "success", _put(4, False), "ends"),
        (DATA, "index", _put(7, 6), "numbering"),
        (DATA, "frame_index", _put(7, 1), "numbering"),
        (DATA, "episode_index", _put(7, 0), "numbering"),
        (EPISODES, "data/file_index", _put(4, 1), "files"),
        (EPISODES, "tasks", _put(4, ["push the can to the goal"]), "tasks"),
        (EPISODES, "tasks", _put(4, []), "tasks"),
        (DATA, "task_index", _put(7, 2), "tasks"),
        (DATA, "timestamp", _put(7, 0.21), "times"),
        (DATA, "next.done", _put(7, True), "ends"),
        (DATA, "next.success", _put(9, False), "ends"),
        (DATA, "observation.com", _move(7, 1, np.nan), "finite"),
        (DATA, "observation.com", _move(7, 0, 0.3), "com"),
        (DATA, "action", _move(7, 5, np.inf), "finite"),
        (DATA, "contact.analytic", _move(7, 1, np.nan), "finite"),
        (DATA, "contact.measured", _move(7, 1, np.nan), "finite"),
        (DATA, "observation.object_pose", _move(7, 3, 1e-3), "quaternions"),
        (DATA, "observation.tool_pose", _move(7, 1, 1e-3), "quaternions"),
        (DATA, "keypoint", _move(7, 0, 1e-4), "labels"),
        (DATA, "keypoint", _put(7, [np.nan] * 3), "labels"),
    ],
)
def test_what_is_wrong_is_found(
    copy: Path, file: str, column: str, change: Callable[[list[Any]], object], check: str
) -> None:
    edit_table(copy / file, lambda table: set_values(table, column, change))
    checks = check_dataset(open_dataset(copy))
    assert not checks[check].ok
    assert checks[check].found


@pytest.mark.parametrize(
    ("column", "change", "check"),
    [
        ("observation.object_pose", lambda v: v[7].__setitem__(slice(4), [0.0] * 4), "quaternions"),
        ("observation.object_pose", lambda v: v[7].__setitem__(slice(4), [np.nan] * 4), "finite"),
        ("observation.object_pose", _put(7, [np.nan] * 7), "finite"),
    ],
)
def test_what_needs_poses_is_not_measured_without(
    copy: Path, column: str, change: Callable[[list[Any]], object], check: str
) -> None:
    edit_table(copy / DATA, lambda table: set_values(table, column, change))
    checks = check_dataset(open_dataset(copy))
    assert not checks[check].ok
    for name in ("labels", "label_distance", "clouds", "com"):
        assert not checks[name].ok
        assert checks[name].found == f"not measured, because {check} is wrong"
    assert checks["times"].ok


def test_labels_far_from_the_object_are_found(copy: Path) -> None:
    _shift_labels_and_contacts(copy)
    checks = check_dataset(open_dataset(copy))
    assert [name for name, check in checks.items() if not check.ok] == ["label_distance"]
    assert float(checks["label_distance"].found) > 0.1


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda f: (f / "meta/job.yaml").unlink(), r"meta/job\.yaml: cannot be read"),
        (lambda f: (f / "meta/job.yaml").write_text("{objects: []}"), r"objects is \[\]"),
        (lambda f: (f / "meta/scenario.yaml").unlink(), r"meta/scenario\.yaml: cannot be read"),
        (lambda f: (f / "meta/stats.json").unlink(), r"meta/stats\.json: cannot be read"),
        (
            lambda f: edit_json(f / "meta/stats.json", lambda s: s["action"].pop("std")),
            r"meta/stats\.json: of action not all statistics are there; allowed: min, max",
        ),
        (lambda f: (f / "meta/tasks.parquet").unlink(), r"tasks\.parquet: is missing; allowed"),
        (
            lambda f: edit_table(f / "meta/tasks.parquet", lambda t: t.drop_columns(["task"])),
            r"tasks\.parquet: column task is missing",
        ),
    ],
)
def test_files_that_it_needs_are_named(
    copy: Path, damage: Callable[[Path], object], message: str
) -> None:
    damage(copy)
    with pytest.raises(UserError, match=message):
        check_dataset(open_dataset(copy))


def test_an_own_object_that_was_exchanged_is_found_and_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "home"))
    mine = user_objects_dir() / "mine"
    shutil.copytree(object_folder("can"), mine)
    folder = write_data(tmp_path / "data", [("mine", 1.0), ("block", 1.0)], episodes=2)
    with (folder / JOB).open("a") as job:
        job.write(f"{USER_OBJECTS}: {user_objects_digest(['mine', 'block'])}\n")
    assert check_dataset(open_dataset(folder))["objects"].ok
    read_rows(folder)
    (mine / "object.json").write_text((object_folder("mug") / "object.json").read_text())
    check = check_dataset(open_dataset(folder))["objects"]
    assert (check.ok, check.found) == (False, "other files of mine")
    words = r"data: the files of mine are not those that its episodes were made with; allowed"
    for use in (read_rows, lambda f: check_export(open_dataset(f), tmp_path / "copy")):
        with pytest.raises(UserError, match=words):
            use(folder)
