"""Arrays and summaries as Parquet files, and files written whole or not at all."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

TEMPORARY_SUFFIX = ".partial"

Rows = Mapping[str, NDArray[np.generic]]


def table_from_rows(episodes: Sequence[Rows]) -> pa.Table:
    """Joins the rows of episodes into one table.

    Args:
        episodes: for each episode the columns, all with the same names; a column is an
            array (n,), or (n, d...) which becomes lists of fixed length.
    """
    names = list(episodes[0])
    return pa.table(
        {name: _column([np.asarray(rows[name]) for rows in episodes]) for name in names}
    )


def table_from_summaries(summaries: Sequence[Mapping[str, object]]) -> pa.Table:
    """Makes a table of one row per mapping; columns keep the order of the first."""
    return pa.Table.from_pylist([dict(summary) for summary in summaries])


def parquet_bytes(table: pa.Table) -> bytes:
    """Returns a Parquet file with checksums; the same table gives the same bytes."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    return bytes(sink.getvalue().to_pybytes())


def write_atomically(content: bytes, path: Path) -> None:
    """Writes a file beside `path` and renames it.

    Under its name a file is whole, also after a loss of power.

    Raises:
        OSError: the file cannot be written; nothing is left of it.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}{TEMPORARY_SUFFIX}")
    try:
        with partial.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except OSError:
        partial.unlink(missing_ok=True)
        raise


def _column(parts: list[NDArray[np.generic]]) -> pa.Array:
    values = np.concatenate(parts)
    array = pa.array(values.reshape(-1))
    for length in reversed(values.shape[1:]):
        array = pa.FixedSizeListArray.from_arrays(array, length)
    return array
