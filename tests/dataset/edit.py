"""Changes to the files of a data set."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

DATA = "data/chunk-000/file-000.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"


def edit_json(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    """Reads, changes in place and writes."""
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def edit_table(path: Path, change: Callable[[pa.Table], pa.Table]) -> None:
    """Reads, changes and writes."""
    pq.write_table(change(pq.read_table(path)), path)


def set_column(table: pa.Table, name: str, column: pa.Array) -> pa.Table:
    """Replaces a column; its type may be another."""
    return table.set_column(table.column_names.index(name), name, column)


def set_values(table: pa.Table, name: str, change: Callable[[list[Any]], object]) -> pa.Table:
    """Changes the values of a column in place, as a list of Python's."""
    values = table[name].to_pylist()
    change(values)
    return set_column(table, name, pa.array(values, table[name].type))
