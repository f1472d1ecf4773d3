import shutil
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from keypush.dataset.arrays import to_array
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.learning.labels import make_labels
from keypush.learning.rows import COLUMNS, read_rows
from tests.learning.synthetic import STEPS, write_data

OBJECTS = [("can", 0.75), ("block", 1.0)]


@pytest.fixture(scope="module")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_data(tmp_path_factory.mktemp("data"), OBJECTS, episodes=3, failures=1)


def test_rows_are_the_frames_in_order(data_dir: Path) -> None:
    rows = read_rows(data_dir, keep_failures=True)
    assert rows.objects == sorted(OBJECTS)
    assert rows.seeds == [0]
    assert len(rows) == 2 * 3 * STEPS
    np.testing.assert_array_equal(rows.episode, np.repeat(np.arange(6), STEPS))
    np.testing.assert_array_equal(rows.object_index, np.repeat([1, 0], 3 * STEPS))
    frames = open_dataset(data_dir).read(list(COLUMNS.values()))
    for name, field in COLUMNS.items():
        np.testing.assert_array_equal(getattr(rows, name), to_array(frames[field]))
    assert rows.object_pose.dtype == rows.com.dtype == np.float64


def test_failed_episodes_are_left_out_unless_wanted(data_dir: Path) -> None:
    rows, every = read_rows(data_dir), read_rows(data_dir, keep_failures=True)
    np.testing.assert_array_equal(np.unique(rows.episode), [1, 2, 4, 5])
    kept = np.isin(every.episode, rows.episode)
    np.testing.assert_array_equal(rows.object_pose, every.object_pose[kept])
    np.testing.assert_array_equal(rows.object_index, every.object_index[kept])


def test_a_row_group_without_a_success_is_passed_over(data_dir: Path, tmp_path: Path) -> None:
    data = shutil.copytree(data_dir, tmp_path / "data")
    (file,) = data.glob("data/*/*.parquet")
    pq.write_table(pq.read_table(file), file, row_group_size=STEPS)
    np.testing.assert_array_equal(read_rows(data).object_pose, read_rows(data_dir).object_pose)


def test_the_measured_label_is_the_keypoint_that_is_stored(data_dir: Path) -> None:
    labels = make_labels(read_rows(data_dir, keep_failures=True), "measured")
    stored = to_array(open_dataset(data_dir).read(["keypoint"])["keypoint"])
    assert np.isfinite(labels).all()
    np.testing.assert_allclose(labels, stored, atol=1e-7)


def test_data_without_a_success_is_refused(tmp_path: Path) -> None:
    write_data(tmp_path, [("block", 1.0)], episodes=2, failures=2)
    with pytest.raises(UserError, match="found no successful episode of 2; allowed: at least one"):
        read_rows(tmp_path)
    assert len(read_rows(tmp_path, keep_failures=True)) == 2 * STEPS


def test_a_folder_without_a_data_set_is_named(tmp_path: Path) -> None:
    with pytest.raises(
        UserError, match=r"meta/info\.json: cannot be read: .*; allowed: a data set"
    ):
        read_rows(tmp_path)
