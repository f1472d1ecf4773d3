"""Writes data and meta of a data set, episode after episode, in files of bounded size."""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from keypush.dataset.arrays import to_column
from keypush.dataset.episode_stats import STATS, TotalStats, episode_stats
from keypush.dataset.features import Feature, arrow_schema
from keypush.dataset.frames import Columns
from keypush.dataset.layout import (
    CODEBASE_VERSION,
    DATA_PATH,
    EPISODE_COLUMNS,
    EPISODES_PATH,
    FILES_PER_CHUNK,
    FORMAT,
    INFO,
    KEYPUSH_FORMAT,
    MEGABYTES_PER_FILE,
    STATS_FILE,
    TASKS,
    file_path,
    parquet_options,
)

_GROUP_BYTES = 16_000_000
"""A row group has about this many bytes before it is compressed."""


class DatasetWriter:
    """Takes one episode at a time; holds no more than a row group of frames in memory.

    As a context manager it finishes the data set at the end, or lets go of it after an error.
    """

    def __init__(
        self, folder: Path, features: tuple[Feature, ...], summaries: pa.Schema, fps: int
    ) -> None:
        """Starts a data set.

        Args:
            folder: exists and is empty.
            features: fields of the frames.
            summaries: names and types of what is told of each episode.
            fps: policy steps per second.
        """
        self._folder, self._features, self._fps = folder, features, fps
        self.summaries = summaries
        self._tasks: dict[str, int] = {}
        self._totals = {feature.name: TotalStats() for feature in features}
        self._episodes = self._frames = 0
        schema = pa.schema([*EPISODE_COLUMNS, *summaries, *_stats_fields(features)])
        self._data = _Files(folder, DATA_PATH, arrow_schema(features))
        self._meta = _Files(folder, EPISODES_PATH, schema)
        self._waiting: list[pa.Table] = []
        self._waiting_bytes = 0
        self._records: list[dict[str, Any]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if kind is None:
            self._close()
        else:
            self._data.abandon()
            self._meta.abandon()

    def add(self, columns: Columns, task: str, summary: Mapping[str, Any]) -> None:
        """Adds an episode.

        Args:
            columns: all fields, (n, ...), but those that number frames, episodes and tasks.
            task: what the robot is to do, in words.
            summary: what is told of the episode.
        """
        table, stats = self._number(columns, self._tasks.setdefault(task, len(self._tasks)))
        self._records.append({
            "episode_index": self._episodes,
            "tasks": [task],
            "length": len(table),
            "dataset_from_index": self._frames,
            "dataset_to_index": self._frames + len(table),
            **summary,
            **stats,
        })  # fmt: skip
        self._waiting.append(table)
        self._episodes += 1
        self._frames += len(table)
        self._waiting_bytes += table.nbytes
        if self._waiting_bytes >= _GROUP_BYTES:
            self._flush()

    def _close(self) -> None:
        """Writes what is left, and `meta/info.json` last."""
        self._flush()
        self._data.close()
        self._meta.close()
        pq.write_table(_task_table(list(self._tasks)), self._folder / TASKS, compression="zstd")
        totals = {name: total.describe() for name, total in self._totals.items()}
        write_json(totals, self._folder / STATS_FILE)
        write_json({"format": KEYPUSH_FORMAT}, self._folder / FORMAT)
        write_json(self._info(), self._folder / INFO)

    def _number(self, columns: Columns, task: int) -> tuple[pa.Table, dict[str, Any]]:
        count = len(columns["timestamp"])
        steps = np.arange(count)
        numbered = {
            **columns,
            "frame_index": steps,
            "episode_index": np.full(count, self._episodes),
            "index": steps + self._frames,
            "task_index": np.full(count, task),
        }
        stats: dict[str, Any] = {}
        stored = {}
        for feature in self._features:
            values = np.asarray(numbered[feature.name]).astype(feature.dtype)
            stored[feature.name] = to_column(values, feature.arrow_type)
            found = episode_stats(values)
            self._totals[feature.name].add(found)
            stats |= {f"stats/{feature.name}/{name}": found[name].tolist() for name in STATS}
        return pa.table(stored, schema=arrow_schema(self._features)), stats

    def _flush(self) -> None:
        if not self._records:
            return
        chunk, file = self._data.write(pa.concat_tables(self._waiting))
        place = {"data/chunk_index": chunk, "data/file_index": file}
        self._meta.write_records([record | place for record in self._records])
        self._waiting.clear()
        self._waiting_bytes = 0
        self._records.clear()

    def _info(self) -> dict[str, Any]:
        return {
            "codebase_version": CODEBASE_VERSION,
            "robot_type": "panda",
            "total_episodes": self._episodes,
            "total_frames": self._frames,
            "total_tasks": len(self._tasks),
            "chunks_size": FILES_PER_CHUNK,
            "data_files_size_in_mb": MEGABYTES_PER_FILE,
            "video_files_size_in_mb": 200,
            "fps": self._fps,
            "splits": {"train": f"0:{self._episodes}"},
            "data_path": DATA_PATH,
            "video_path": None,
            "features": {feature.name: feature.describe() for feature in self._features},
        }


class _Files:
    """Numbered Parquet files of one schema, each of at most `MEGABYTES_PER_FILE`."""

    def __init__(self, folder: Path, pattern: str, schema: pa.Schema) -> None:
        self._folder, self._pattern, self._schema = folder, pattern, schema
        self._number = -1
        self._path = folder
        self._writer: pq.ParquetWriter | None = None

    def write(self, table: pa.Table) -> tuple[int, int]:
        """Writes a row group; returns chunk and number of its file."""
        place = self._make_room(table.nbytes)
        assert self._writer is not None
        self._writer.write_table(table, row_group_size=max(1, len(table)))
        return place

    def write_records(self, records: list[dict[str, Any]]) -> None:
        """Writes episodes as a row group, with the place that they get."""
        size = pa.Table.from_pylist(records, schema=self._schema).nbytes
        chunk, file = self._make_room(size)
        place = {"meta/episodes/chunk_index": chunk, "meta/episodes/file_index": file}
        self.write(pa.Table.from_pylist([r | place for r in records], schema=self._schema))

    def close(self) -> None:
        """Ends the file that is open."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def abandon(self) -> None:
        """Lets go of the file that is open, whatever becomes of it."""
        if self._writer is not None:
            with suppress(OSError):
                self._writer.close()
            # Where it could not be closed, it would try and fail once more when it is collected.
            self._writer.is_open = False
            self._writer = None

    def _make_room(self, size: int) -> tuple[int, int]:
        """Opens the next file if `size` bytes, uncompressed, might not fit into this one."""
        if self._writer is None or self._path.stat().st_size + size > MEGABYTES_PER_FILE * 1e6:
            self.close()
            self._number += 1
            relative, _, _ = file_path(self._pattern, self._number)
            self._path = self._folder / relative
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = pq.ParquetWriter(
                self._path, self._schema, **parquet_options(self._schema)
            )
        _, chunk, file = file_path(self._pattern, self._number)
        return chunk, file


def write_json(content: dict[str, Any], path: Path) -> None:
    """Writes JSON, spelled as LeRobot spells it."""
    path.write_text(json.dumps(content, indent=4, ensure_ascii=False), encoding="utf-8")


def _stats_fields(features: tuple[Feature, ...]) -> list[pa.Field]:
    return [
        pa.field(
            f"stats/{feature.name}/{name}",
            pa.list_(pa.int64() if name == "count" else pa.float64()),
        )
        for feature in features
        for name in STATS
    ]


def _task_table(tasks: list[str]) -> pa.Table:
    """The tasks as pandas reads them: in words as the index, numbered in `task_index`."""
    index = {"name": "task", "field_name": "task", "pandas_type": "unicode",
             "numpy_type": "object", "metadata": None}  # fmt: skip
    column = {"name": "task_index", "field_name": "task_index", "pandas_type": "int64",
              "numpy_type": "int64", "metadata": None}  # fmt: skip
    pandas = {"index_columns": ["task"], "column_indexes": [], "columns": [column, index]}
    table = pa.table({"task_index": pa.array(range(len(tasks)), pa.int64()), "task": tasks})
    return table.replace_schema_metadata({"pandas": json.dumps(pandas)})
