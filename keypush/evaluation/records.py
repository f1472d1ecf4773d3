"""`records.parquet`: one row per evaluated episode, the same columns whatever was evaluated."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from keypush.atomic_file import write_whole
from keypush.errors import UserError, one_line
from keypush.rollout.parquet import parquet_bytes

RECORDS_FILE = "records.parquet"
"""Its name in the folder of an evaluation."""
RECORDS_FORMAT = "3"
"""Grows when columns or their meanings change; 3 has reasons, 2 is read as one without any."""
_WITHOUT_REASONS = "2"
_READ = (_WITHOUT_REASONS, RECORDS_FORMAT)


def _column(name: str, kind: pa.DataType, meaning: str, unit: str = "") -> pa.Field:
    return pa.field(name, kind, nullable=False, metadata={"meaning": meaning, "unit": unit})


def _setting(name: str, meaning: str, unit: str = "") -> pa.Field:
    return _column(name, pa.float64(), meaning, unit)


def _length(name: str, meaning: str) -> pa.Field:
    """A measured length: single precision is 0.1 µm, at half the size of the file."""
    return _column(name, pa.float32(), meaning, "m")


RECORDS = pa.schema(
    [
        _column("policy", pa.string(), "who drove the tool"),
        _column("weights", pa.string(), "file name of the policy's weights, empty without any"),
        _column("object", pa.string(), "name of the object"),
        _column("set", pa.string(), "train, id, ood or user"),
        _setting("size_ratio", "size relative to the object's own"),
        _setting("com_shift", "wanted horizontal shift of the centre of mass", "m"),
        _column("com_capped", pa.bool_(), "whether the shift was less than wanted"),
        _setting("cloud_deviation", "standard deviation of each coordinate of the cloud", "m"),
        _setting("push_speed", "speed that the tool was given while it pushes", "m/s"),
        _column("seed", pa.int64(), "seed of the scenario"),
        _column("episode", pa.int32(), "number of the episode"),
        _column("success", pa.bool_(), "object upright on the table within the goal's radius"),
        _column("settled_success", pa.bool_(), "the same, after the tool has stopped"),
        _column("outcome", pa.string(), "success, toppled, fell, timed_out or policy_failed"),
        _column("reason", pa.string(), "why the policy failed, else empty"),
        _column("steps", pa.int32(), "policy steps until the outcome was known"),
        _length("object_path", "length of the path of the object's origin in xy"),
        _length("tool_path", "length of the path of the tool tip"),
        _length("keypoint_error", "mean distance of keypoint and measured contact"),
        _length("start_x", "object's origin in W at the start"),
        _length("start_y", "object's origin in W at the start"),
        _length("goal_x", "goal in W"),
        _length("goal_y", "goal in W"),
        _length("final_x", "object's origin in W at the end"),
        _length("final_y", "object's origin in W at the end"),
        _column("folder", pa.string(), "of rows/ and episodes/, relative to this file's folder"),
    ],
    metadata={"keypush_records": RECORDS_FORMAT},
)
"""The columns: name, type, and as metadata meaning and unit; `docs/evaluation.md` defines them."""


def write_records(records: Sequence[Mapping[str, Any]] | pa.Table, path: Path) -> None:
    """Writes records, whole or not at all; the same records give the same bytes.

    Args:
        records: a mapping with all columns of `RECORDS` for each episode, or a table with them.
        path: of the file.

    Raises:
        UserError: the file cannot be written.
    """
    if isinstance(records, pa.Table):
        table = records.select(RECORDS.names).cast(RECORDS)
    else:
        table = pa.Table.from_pylist([dict(record) for record in records], schema=RECORDS)
    lengths = [field.name for field in RECORDS if field.type == pa.float32()]
    content = parquet_bytes(table.replace_schema_metadata(RECORDS.metadata), distinct=lengths)
    write_whole(path, content)


def read_records(path: Path) -> pa.Table:
    """Reads records in the columns and types of `RECORDS`; columns of others are left out.

    A table without a format, as another program may have written it, is judged by its columns.

    Raises:
        UserError: the file cannot be read or has a format that is not known, or a column is
            missing, of another type or has holes; names the file and the column.
    """
    try:
        table = pq.read_table(path, page_checksum_verification=True)
    except (OSError, pa.ArrowException) as error:
        raise UserError(f"{path}: cannot be read: {one_line(error)}") from error
    told = (table.schema.metadata or {}).get(b"keypush_records", RECORDS_FORMAT.encode())
    made = told.decode(errors="replace")
    if made not in _READ:
        raise UserError(
            f"{path}: keypush_records, its format, is {made!r}; allowed: {', '.join(_READ)} "
            "(another version of keypush wrote it)"
        )
    if made == _WITHOUT_REASONS:
        table = table.append_column("reason", pa.array([""] * len(table), pa.string()))
    for field in RECORDS:
        if field.name not in table.column_names:
            raise UserError(f"{path}: lacks the column {field.name}; allowed: {_names()}")
        column = table[field.name]
        if column.type != field.type:
            raise UserError(f"{path}: column {field.name} is {column.type}; allowed: {field.type}")
        if column.null_count:
            raise UserError(f"{path}: column {field.name} has empty entries; allowed: none")
    return table.select(RECORDS.names).cast(RECORDS)


def _names() -> str:
    return f"the columns {', '.join(RECORDS.names)}"
