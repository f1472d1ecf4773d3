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
