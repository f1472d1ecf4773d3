"""Arrays and summaries as Parquet files."""

from collections.abc import Mapping, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

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


def parquet_bytes(table: pa.Table, distinct: Sequence[str] = ()) -> bytes:
    """Returns a Parquet file with checksums; the same table gives the same bytes.

    Args:
        table: the content.
        distinct: columns of floats that hardly repeat: a dictionary would make them larger.
    """
    sink = pa.BufferOutputStream()
    pq.write_table(
        table,
        sink,
        compression="zstd",
        write_page_checksum=True,
        use_dictionary=[name for name in table.column_names if name not in distinct],
        use_byte_stream_split=list(distinct),
    )
    return bytes(sink.getvalue().to_pybytes())


def _column(parts: list[NDArray[np.generic]]) -> pa.Array:
    values = np.concatenate(parts)
    array = pa.array(values.reshape(-1))
    for length in reversed(values.shape[1:]):
        array = pa.FixedSizeListArray.from_arrays(array, length)
    return array
