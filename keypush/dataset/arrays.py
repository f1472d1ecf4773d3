"""Columns of tables as arrays, and the other way round."""

from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.types as types
from numpy.typing import NDArray


def to_array(column: pa.ChunkedArray) -> NDArray[Any]:
    """Returns a column of numbers, or of lists of fixed length, as an array (n, ...)."""
    array = column.combine_chunks()
    shape = [len(array)]
    while types.is_fixed_size_list(array.type):
        shape.append(array.type.list_size)
        array = array.flatten()
    return np.asarray(array.to_numpy(zero_copy_only=False)).reshape(shape)


def null_count(column: pa.ChunkedArray) -> int:
    """Counts what has no value, in lists too; NaN is a value."""
    count = int(column.null_count)
    if types.is_list(column.type) or types.is_fixed_size_list(column.type):
        count += sum(null_count(pa.chunked_array([chunk.flatten()])) for chunk in column.chunks)
    return count


def not_finite(values: NDArray[Any], *, may_be_nan: bool) -> NDArray[np.bool_]:
    """Says which numbers of an array (n, ...) are not finite where they must be, (n, k).

    Args:
        values: numbers or bools.
        may_be_nan: whether a row may be NaN, which all of its numbers are then.
    """
    rows = values.reshape(len(values), -1)
    if rows.dtype.kind != "f":
        return np.zeros(rows.shape, dtype=bool)
    bad = ~np.isfinite(rows)
    if may_be_nan:
        bad &= ~np.isnan(rows).all(axis=1, keepdims=True)
    return np.asarray(bad)


def to_column(values: NDArray[np.generic], kind: pa.DataType) -> pa.Array:
    """Returns an array (n, ...) as a column of this type, (n,) or (n, 1) as a plain one."""
    inner, lengths = kind, []
    while types.is_fixed_size_list(inner):
        lengths.append(inner.list_size)
        inner = inner.value_type
    array = pa.array(np.ascontiguousarray(values).reshape(-1)).cast(inner, safe=False)
    for length in reversed(lengths):
        array = pa.FixedSizeListArray.from_arrays(array, length)
    return array
