"""Data sets that are damaged or foreign are refused in one line that names what is wrong."""

import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from keypush.dataset.check import check_dataset
from keypush.dataset.read import open_dataset
from keypush.dataset.statistics import dataset_statistics
from keypush.errors import UserError
from tests.dataset.edit import DATA, EPISODES, edit_json, edit_table, set_column, set_values

INFO = "meta/info.json"


def _info(change: Callable[[dict[str, Any]], object]) -> Callable[[Path], object]:
    return lambda folder: edit_json(folder / INFO, change)


def _table(file: str, change: Callable[[pa.Table], pa.Table]) -> Callable[[Path], object]:
    return lambda folder: edit_table(folder / file, change)


def _episode(column: str, value: object) -> Callable[[Path], object]:
    return _table(EPISODES, lambda t: set_values(t, column, lambda v: v.__setitem__(4, value)))


def _feature(name: str, **entry: object) -> Callable[[Path], object]:
    return _info(lambda info: info["features"][name].update(entry))


DAMAGES: list[tuple[Callable[[Path], object], str]] = [
    (lambda f: shutil.rmtree(f / "meta"), r"meta/info\.json: cannot be read"),
    (lambda f: (f / INFO).write_text("{"), r"meta/info\.json: cannot be read: .*; allowed: a data"),
    (lambda f: (f / INFO).write_text("[]"), r"info\.json: holds no JSON object"),
    (_info(lambda i: i.pop("fps")), "fps is None; allowed: whole numbers above 0"),
    (_info(lambda i: i.pop("features")), "features is missing"),
    (_info(lambda i: i.update(codebase_version="v2.1")), r"is 'v2\.1'; allowed: 'v3\.0'"),
    (_info(lambda i: i.update(total_frames=46)), "total_frames is 46, but the files have 45"),
    (_info(lambda i: i.update(total_episodes=8)), "total_episodes is 8, but the files have 9"),
    (_feature("keypoint", dtype="float64"), "feature keypoint is .*float64.*; allowed: .*float32"),
    (_feature("action", shape=[7]), r"feature action is .*\[7\].*; allowed: .*\[6\]"),
    (_info(lambda i: i["features"].pop("stage")), "feature stage is missing; allowed"),
    (_info(lambda i: i["features"].update(reward={})), "features has reward; allowed: those of"),
    (
        _info(lambda i: i["features"].update({"observation.point_cloud": {"shape": [0]}})),
        r"point_cloud has shape \[0\]; allowed: \[points, 3\]",
    ),
    (
        lambda f: edit_json(f / "meta/keypush.json", lambda k: k.update(format=2)),
        r"keypush\.json: format is 2; allowed: 1",
    ),
    (lambda f: (f / DATA).unlink(), r"data/chunk-000/file-000\.parquet: is missing"),
    (lambda f: (f / DATA).write_bytes(b"no parquet"), r"file-000\.parquet: cannot be read"),
    (lambda f: (f / EPISODES).unlink(), r"episodes/chunk-000/file-000\.parquet: is missing"),
    (lambda f: (f / EPISODES).write_bytes(b""), r"file-000\.parquet: cannot be read"),
    (_table(DATA, lambda t: t.drop_columns(["stage"])), "column stage is missing; allowed: int64"),
    (_table(DATA, lambda t: t.append_column("x", t["stage"])), "foreign columns: x"),
    (
        _table(DATA, lambda t: set_column(t, "stage", t["stage"].cast(pa.int8()))),
        "column stage is int8; allowed: int64",
    ),
    (
        _table(DATA, lambda t: set_column(t, "observation.goal", t["keypoint"])),
        r"column observation\.goal is .*\[3\]; allowed: .*\[2\]",
    ),
    (_table(DATA, lambda t: t.slice(1)), "total_frames is 45, but the files have 44"),
    (_table(EPISODES, lambda t: t.drop_columns(["success"])), "column success is missing"),
    (
        _table(EPISODES, lambda t: set_column(t, "length", t["length"].cast(pa.int32()))),
        "column length is int32; allowed: int64",
    ),
    *(
        (_episode(column, None), f"column {column} has no value in 1 places; allowed: a value in")
        for column in ("size_ratio", "success", "seed", "object", "tasks", "length")
    ),
    (_episode("size_ratio", 0.0), "size_ratio is 0; allowed: above 0, finite"),
    (_episode("size_ratio", -1.0), "size_ratio is -1; allowed: above 0"),
    (_episode("size_ratio", math.nan), "size_ratio is nan; allowed: above 0"),
    (_episode("length", 0), "length is 0; allowed: from 1"),
    (_episode("seed", -1), "seed is -1; allowed: from 0"),
]


@pytest.mark.parametrize(("damage", "message"), DAMAGES, ids=[m[:40] for _, m in DAMAGES])
def test_what_is_wrong_is_named(copy: Path, damage: Callable[[Path], object], message: str) -> None:
    assert open_dataset(copy).frames == 45
    damage(copy)
    with pytest.raises(UserError) as caught:
        open_dataset(copy)
    text = str(caught.value)
    assert re.search(message, text), text
    assert str(copy) in text
    assert "\n" not in text


@given(st.floats(0.0, 1.0, exclude_max=True), st.integers(1, 255))
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_byte_that_changed_is_found_or_does_no_harm(
    synthetic: Path, tmp_path: Path, place: float, change: int
) -> None:
    shutil.rmtree(tmp_path / "copy", ignore_errors=True)
    for name in ("data", "meta"):
        shutil.copytree(synthetic / name, tmp_path / "copy" / name)
    path = tmp_path / "copy" / DATA
    content = bytearray(path.read_bytes())
    content[int(place * len(content))] ^= change
    path.write_bytes(content)
    assert DATA in _complaint(tmp_path / "copy")


def _complaint(folder: Path) -> str:
    """What is said of a data set, or where all is well, of which file it was not said."""
    try:
        checks = check_dataset(open_dataset(folder))
    except UserError as error:
        return str(error)
    assert all(check.ok for check in checks.values())
    return f"nothing is wrong with {DATA}"


@pytest.mark.parametrize("value", [None, [1.0, None, 2.0]])
def test_frames_without_a_value_are_refused(copy: Path, value: object) -> None:
    _table(DATA, lambda t: set_values(t, "keypoint", lambda v: v.__setitem__(7, value)))(copy)
    dataset = open_dataset(copy)
    for read in (check_dataset, dataset_statistics, lambda d: d.episode(1)):
        with pytest.raises(UserError, match="column keypoint has no value in 1 places"):
            read(dataset)


@pytest.mark.parametrize(
    "change",
    [
        lambda v: v[7].__setitem__(slice(4), [0.0] * 4),
        lambda v: v[7].__setitem__(2, math.nan),
    ],
)
def test_an_episode_with_frames_that_are_no_poses_is_refused(
    copy: Path, change: Callable[[list[Any]], object]
) -> None:
    _table(DATA, lambda t: set_values(t, "observation.object_pose", change))(copy)
    dataset = open_dataset(copy)
    told = r"observation\.object_pose is \[.*\] in frame 2 of episode 1; allowed: what `keypush"
    with pytest.raises(UserError, match=told):
        dataset.episode(1)
    with pytest.raises(UserError, match=told):
        list(dataset.each_episode())
    assert len(dataset.episode(0)[1]) == 5


def test_there_is_no_such_episode(synthetic: Path) -> None:
    for number in (-1, 9):
        with pytest.raises(UserError, match=rf"episode is {number}; allowed in .*: 0 to 8"):
            open_dataset(synthetic).episode(number)


def test_statistics_count_what_is_there(synthetic: Path) -> None:
    found = dataset_statistics(open_dataset(synthetic))
    assert (found["episodes"], found["frames"], found["success"]) == (9, 45, 6)
    assert found["frames_with_keypoint"] == 45
    assert found["outcomes"] == {"fell": 3, "success": 6}
    assert list(found["objects"]) == ["can", "block", "mug"]
    assert found["objects"]["mug"] == {"episodes": 3, "success": 2, "frames": 15}
    assert sum(found["histograms"]["size_ratio"]["counts"]) == 9
    assert "length" not in found["histograms"]  # it is the same everywhere
