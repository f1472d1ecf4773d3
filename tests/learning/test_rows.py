from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from keypush.errors import UserError
from keypush.learning.rows import read_rows
from tests.learning.synthetic import STEPS, write_data


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    return write_data(tmp_path / "data", [("block", 1.0), ("can", 0.75)], episodes=3)


def _edit(path: Path, table: pa.Table) -> None:
    pq.write_table(table, path)


def test_rows_are_ordered_and_complete(data_dir: Path) -> None:
    file = data_dir / "rows" / "part-0.parquet"
    table = pq.read_table(file)
    shuffled = table.take(pa.array(np.random.default_rng(0).permutation(len(table))))
    expected = read_rows(data_dir)
    # Two files, the rows in any order.
    _edit(file, shuffled.slice(0, 7))
    _edit(file.with_name("part-1.parquet"), shuffled.slice(7))
    rows = read_rows(data_dir)
    assert rows.objects == [("block", 1.0), ("can", 0.75)]
    assert len(rows) == 2 * 3 * STEPS
    np.testing.assert_array_equal(rows.episode, np.repeat(np.arange(6), STEPS))
    np.testing.assert_array_equal(rows.object_index, np.repeat([0, 1], 3 * STEPS))
    np.testing.assert_array_equal(rows.object_pose, expected.object_pose)
    by_hand = table.filter(pa.compute.equal(table["object"], "can")).sort_by(
        [("episode", "ascending"), ("step", "ascending")]
    )
    np.testing.assert_array_equal(rows.goal[3 * STEPS :], by_hand["goal"].to_pylist())


def test_fixed_size_lists_read_the_same(data_dir: Path) -> None:
    expected = read_rows(data_dir)
    file = data_dir / "rows" / "part-0.parquet"
    table = pq.read_table(file)
    column = table["goal"].cast(pa.list_(pa.float64(), 2))
    _edit(file, table.set_column(table.schema.get_field_index("goal"), "goal", column))
    np.testing.assert_array_equal(read_rows(data_dir).goal, expected.goal)


def test_keys_may_have_other_widths_in_rows_than_in_episodes(data_dir: Path) -> None:
    file = data_dir / "rows" / "part-0.parquet"
    table = pq.read_table(file)
    column = table["episode"].cast(pa.int32())
    _edit(file, table.set_column(table.schema.get_field_index("episode"), "episode", column))
    assert len(read_rows(data_dir)) == 2 * 3 * STEPS


def test_failed_episodes_are_left_out_unless_wanted(data_dir: Path) -> None:
    file = data_dir / "episodes" / "part-0.parquet"
    table = pq.read_table(file)
    success = pa.array([False, True, True, True, True, True])
    _edit(file, table.set_column(table.schema.get_field_index("success"), "success", success))
    assert len(read_rows(data_dir)) == 5 * STEPS
    assert len(read_rows(data_dir, keep_failures=True)) == 6 * STEPS


def test_missing_and_empty_data_are_named(data_dir: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"nowhere/rows: found no \*\.parquet"):
        read_rows(tmp_path / "nowhere")
    file = data_dir / "episodes" / "part-0.parquet"
    table = pq.read_table(file)
    _edit(file, table.slice(0, 0))
    with pytest.raises(UserError, match="found no rows of successful episodes"):
        read_rows(data_dir)
    _edit(file, table.drop_columns(["success"]))
    with pytest.raises(UserError, match=r"part-0\.parquet: columns missing: success"):
        read_rows(data_dir)
    file.write_bytes(b"no parquet")
    with pytest.raises(UserError, match=r"part-0\.parquet: cannot be read"):
        read_rows(data_dir)


def test_lists_of_wrong_length_are_refused(data_dir: Path) -> None:
    file = data_dir / "rows" / "part-0.parquet"
    table = pq.read_table(file)
    com = table["com"]
    _edit(file, table.set_column(table.schema.get_field_index("goal"), "goal", com))
    with pytest.raises(UserError, match="column goal: allowed: 2 numbers"):
        read_rows(data_dir)
