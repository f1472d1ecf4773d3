"""`records.parquet`: what is written is read again, and other files are refused by their column."""

from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from keypush.errors import UserError
from keypush.evaluation.records import RECORDS, read_records, write_records


def record(**fields: object) -> dict[str, Any]:
    """A record with some fields given."""
    kinds = {pa.string(): "", pa.float64(): 0.0, pa.bool_(): False}
    return {field.name: kinds.get(field.type, 0) for field in RECORDS} | fields


def test_records_survive_a_file(tmp_path: Path) -> None:
    nan = float("nan")
    given = [record(object="mug", episode=3, success=True), record(keypoint_error=nan, folder="a")]
    write_records(given, tmp_path / "r.parquet")
    table = read_records(tmp_path / "r.parquet")
    assert table.schema.equals(RECORDS, check_metadata=True)
    assert table["object"].to_pylist() == ["mug", ""]
    assert table["success"].to_pylist() == [True, False]
    assert str(table["keypoint_error"].to_pylist()) == "[0.0, nan]"
    write_records(table, tmp_path / "again.parquet")
    assert (tmp_path / "again.parquet").read_bytes() == (tmp_path / "r.parquet").read_bytes()


def test_every_column_says_what_it_is() -> None:
    for field in RECORDS:
        assert field.metadata[b"meaning"]
        assert field.metadata[b"unit"] in (b"", b"m", b"m/s")
    lengths = {f.name for f in RECORDS if f.metadata[b"unit"] == b"m"}
    assert {"object_path", "tool_path", "keypoint_error", "com_shift", "final_y"} <= lengths


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t.drop_columns(["tool_path"]), "lacks the column tool_path"),
        (
            lambda t: t.set_column(0, "policy", pa.array([1])),
            "column policy is int64; allowed: string",
        ),
        (
            lambda t: t.set_column(10, "episode", pa.array([None], pa.int32())),
            "column episode has empty entries",
        ),
    ],
)
def test_a_column_that_is_wrong_is_named(change: Any, words: str, tmp_path: Path) -> None:
    path = tmp_path / "r.parquet"
    write_records([record()], path)
    plain = pa.schema([pa.field(field.name, field.type) for field in RECORDS])
    pq.write_table(change(pq.read_table(path).cast(plain)), path)
    with pytest.raises(UserError, match=words) as caught:
        read_records(path)
    assert str(path) in str(caught.value)


def test_what_is_no_parquet_is_refused(tmp_path: Path) -> None:
    (tmp_path / "r.parquet").write_text("no table")
    with pytest.raises(UserError, match=r"r\.parquet: cannot be read"):
        read_records(tmp_path / "r.parquet")
    with pytest.raises(UserError, match=r"none\.parquet: cannot be read"):
        read_records(tmp_path / "none.parquet")


def test_records_of_before_there_were_reasons_are_read(tmp_path: Path) -> None:
    given = pa.Table.from_pylist([record(outcome="toppled")], schema=RECORDS)
    old = given.drop_columns(["reason"]).replace_schema_metadata({"keypush_records": "2"})
    pq.write_table(old, tmp_path / "r.parquet")
    assert read_records(tmp_path / "r.parquet").equals(given)


@pytest.mark.parametrize("made", ["1", "4", "", "3.0"])
def test_records_of_an_unknown_format_are_refused(made: str, tmp_path: Path) -> None:
    table = pa.Table.from_pylist([record()], schema=RECORDS)
    told = table.replace_schema_metadata({"keypush_records": made})
    pq.write_table(told, tmp_path / "r.parquet")
    words = f"r.parquet: keypush_records, its format, is '{made}'; allowed: 2, 3 "
    with pytest.raises(UserError, match=words):
        read_records(tmp_path / "r.parquet")


def test_records_without_a_format_are_judged_by_their_columns(tmp_path: Path) -> None:
    given = pa.Table.from_pylist([record()], schema=RECORDS)
    pq.write_table(given.replace_schema_metadata(None), tmp_path / "r.parquet")
    assert read_records(tmp_path / "r.parquet").equals(given)


def test_columns_of_others_are_left_out(tmp_path: Path) -> None:
    write_records([record()], tmp_path / "r.parquet")
    table = pq.read_table(tmp_path / "r.parquet").append_column("mine", pa.array([1]))
    pq.write_table(table, tmp_path / "r.parquet")
    assert read_records(tmp_path / "r.parquet").column_names == RECORDS.names
