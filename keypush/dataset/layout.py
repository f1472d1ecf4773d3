"""Where LeRobotDataset v3.0 and keypush put their files, and how these are compressed."""

from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.types as types

CODEBASE_VERSION = "v3.0"
"""Of the LeRobotDataset format."""
KEYPUSH_FORMAT = 1
"""Of the fields; grows when their names, types or meanings change."""
INFO = Path("meta/info.json")
FORMAT = Path("meta/keypush.json")
"""Not in `meta/info.json`, where LeRobot warns of what it does not know."""
STATS_FILE = Path("meta/stats.json")
TASKS = Path("meta/tasks.parquet")
SCENARIO = Path("meta/scenario.yaml")
JOB = Path("meta/job.yaml")
DATA_PATH = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
EPISODES_PATH = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
FILES_PER_CHUNK = 1000
MEGABYTES_PER_FILE = 100
EPISODE_COLUMNS = pa.schema(
    [
        pa.field("episode_index", pa.int64()),
        pa.field("tasks", pa.list_(pa.string())),
        pa.field("length", pa.int64()),
        pa.field("data/chunk_index", pa.int64()),
        pa.field("data/file_index", pa.int64()),
        pa.field("dataset_from_index", pa.int64()),
        pa.field("dataset_to_index", pa.int64()),
        pa.field("meta/episodes/chunk_index", pa.int64()),
        pa.field("meta/episodes/file_index", pa.int64()),
    ]
)
"""What LeRobot wants to know of each episode, besides its statistics."""


def file_path(pattern: str, number: int) -> tuple[Path, int, int]:
    """Returns the path of a numbered file in the data set, its chunk and its number in it."""
    chunk, file = divmod(number, FILES_PER_CHUNK)
    return Path(pattern.format(chunk_index=chunk, file_index=file)), chunk, file


def parquet_options(schema: pa.Schema) -> dict[str, Any]:
    """Returns how `ParquetWriter` packs columns best.

    Bytes of floats are sorted by significance, since neighbouring frames share the high ones;
    whole numbers grow by one from row to row, or stay; everything else has few different values.
    """
    encodings, others = {}, []
    for field in schema:
        path, kind = field.name, field.type
        while types.is_list(kind) or types.is_fixed_size_list(kind):
            path, kind = f"{path}.list.element", kind.value_type
        if types.is_floating(kind):
            encodings[path] = "BYTE_STREAM_SPLIT"
        elif types.is_integer(kind):
            encodings[path] = "DELTA_BINARY_PACKED"
        else:
            others.append(path)
    return {
        "compression": "zstd",
        "compression_level": 9,
        "use_dictionary": others,
        "column_encoding": encodings,
        "write_page_checksum": True,
    }
