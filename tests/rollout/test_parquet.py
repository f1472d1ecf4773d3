"""Parquet files: shapes survive, and files appear whole or not at all."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from keypush.rollout.parquet import table_from_rows, table_from_summaries, write_atomically


def test_columns_keep_shape_type_and_value(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    episodes = [
        {
            "object": np.full(n, "mug"),
            "step": np.arange(n, dtype=np.int32),
            "pose": rng.normal(size=(n, 7)),
            "jacobian": rng.normal(size=(n, 2, 3)),
        }
        for n in (3, 0, 2)
    ]
    write_atomically(table_from_rows(episodes), tmp_path / "rows.parquet")
    table = pq.read_table(tmp_path / "rows.parquet")
    assert table["object"].to_pylist() == ["mug"] * 5
    assert table["step"].to_pylist() == [0, 1, 2, 0, 1]
    assert str(table["step"].type) == "int32"
    for name in ("pose", "jacobian"):
        expected = np.concatenate([rows[name] for rows in episodes])
        np.testing.assert_array_equal(np.array(table[name].to_pylist()), expected)


def test_summaries_become_rows() -> None:
    table = table_from_summaries([{"success": True, "final_position": np.array([1.0, 2.0])}] * 2)
    assert table.to_pylist() == [{"success": True, "final_position": [1.0, 2.0]}] * 2


def test_nothing_is_left_under_the_name_when_writing_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_table: object, path: Path, **_options: object) -> None:
        path.write_bytes(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(pq, "write_table", fail)
    with pytest.raises(OSError, match="disk full"):
        write_atomically(table_from_summaries([{"a": 1}]), tmp_path / "a.parquet")
    assert not (tmp_path / "a.parquet").exists()
