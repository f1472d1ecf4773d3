"""Parquet files: shapes survive, and files appear whole or not at all."""

import resource
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from keypush.atomic_file import write_atomically
from keypush.rollout.parquet import parquet_bytes, table_from_rows, table_from_summaries


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
    write_atomically(parquet_bytes(table_from_rows(episodes)), tmp_path / "rows.parquet")
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


def test_a_file_that_cannot_be_written_whole_leaves_nothing(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            write_atomically(bytes(2000), tmp_path / "a.parquet")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_a_flipped_bit_is_noticed(tmp_path: Path) -> None:
    content = bytearray(parquet_bytes(table_from_rows([{"x": np.arange(1000.0)}])))
    content[200] ^= 1
    write_atomically(bytes(content), tmp_path / "a.parquet")
    with pytest.raises(OSError, match=r"(?i)crc"):
        pq.read_table(tmp_path / "a.parquet", page_checksum_verification=True)


def test_an_interrupted_write_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_file: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(b"content", tmp_path / "a.parquet")
    assert list(tmp_path.iterdir()) == []
