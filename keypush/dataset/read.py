"""Opens a data set: what its files say of themselves is checked before a frame is read."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from keypush.dataset.arrays import null_count, to_array
from keypush.dataset.bad_frame import find_bad_frame
from keypush.dataset.episode_stats import STATS
from keypush.dataset.features import CLOUD, FEATURES, Feature, arrow_schema, cloud_feature
from keypush.dataset.layout import (
    CODEBASE_VERSION,
    DATA_PATH,
    EPISODE_COLUMNS,
    EPISODES_PATH,
    FORMAT,
    INFO,
    JOB,
    KEYPUSH_FORMAT,
    SCENARIO,
    STATS_FILE,
    TASKS,
)
from keypush.errors import UserError, one_line

_ALLOWED = "allowed: a data set that `keypush collect` or `keypush dataset export` wrote"
SUMMARY_TYPES = {
    "object": pa.string(),
    "size_ratio": pa.float64(),
    "seed": pa.int64(),
    "episode": pa.int64(),
    "success": pa.bool_(),
    "settled_success": pa.bool_(),
    "outcome": pa.string(),
    "steps": pa.int64(),
}
"""What keypush itself reads of each episode, besides `EPISODE_COLUMNS`."""
_LEAST = {"length": 1, "seed": 0, "episode": 0}
"""The least that an episode's numbers may be."""


@dataclass(frozen=True)
class DataSet:
    """A data set whose versions, fields, files and counts agree; see `open_dataset`."""

    folder: Path
    features: tuple[Feature, ...]
    """Fields of the frames."""
    fps: int
    """Frames per second."""
    episodes: pa.Table
    """One row per episode, without the statistics."""
    files: Sequence[Path]
    """With the frames, in order."""
    frames_per_file: Sequence[int]

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return sum(self.frames_per_file)

    @property
    def scenario(self) -> Path:
        """The file with the scenario."""
        return self.folder / SCENARIO

    @property
    def job(self) -> Path:
        """The file that tells of the job."""
        return self.folder / JOB

    @cached_property
    def tasks(self) -> dict[str, int]:
        """Numbers of the tasks in words.

        Raises:
            UserError: the file is missing, damaged or foreign.
        """
        path = self.folder / TASKS
        wanted = pa.schema([("task", pa.string()), ("task_index", pa.int64())])
        with _explained(path):
            table = pq.read_table(path)
        _check_columns(path, table.schema, wanted, exact=True)
        _check_no_nulls(path, table)
        return dict(zip(*(table[name].to_pylist() for name in wanted.names), strict=True))

    def check_statistics(self) -> None:
        """Checks that there are statistics of every field; nothing of keypush reads them.

        Raises:
            UserError: the file is missing, damaged or foreign.
        """
        path = self.folder / STATS_FILE
        found = _read_json(path)
        for feature in self.features:
            entry = found.get(feature.name)
            if not isinstance(entry, dict) or not entry.keys() >= set(STATS):
                raise UserError(
                    f"{path}: of {feature.name} not all statistics are there; allowed: "
                    f"{', '.join(STATS)}"
                )

    def batches(self, columns: Sequence[str]) -> Iterator[pa.Table]:
        """Yields some fields of all frames, a row group at a time.

        Raises:
            UserError: a file is damaged, or a value is missing.
        """
        for path in self.files:
            with _explained(path):
                file = pq.ParquetFile(path, page_checksum_verification=True)
                for group in range(file.num_row_groups):
                    table = file.read_row_group(group, columns=list(columns))
                    _check_no_nulls(path, table)
                    yield table

    def read(self, columns: Sequence[str]) -> pa.Table:
        """Reads some fields of all frames; raises as `batches`."""
        schema = arrow_schema(tuple(f for f in self.features if f.name in columns))
        return pa.concat_tables([schema.empty_table(), *self.batches(schema.names)])

    def each_episode(self) -> Iterator[tuple[dict[str, Any], pa.Table]]:
        """Yields what is told of each episode, and its frames; raises as `episode`."""
        names = [feature.name for feature in self.features]
        batches = self.batches(names)
        rest = arrow_schema(self.features).empty_table()
        for number in range(len(self.episodes)):
            told = self.episodes.slice(number, 1).to_pylist()[0]
            while len(rest) < told["length"]:
                batch = next(batches, None)
                if batch is None:
                    raise UserError(
                        f"{self.folder}: the frames end in episode {number}; allowed: as many as "
                        f"{EPISODES_PATH.partition('/chunk')[0]} says"
                    )
                rest = pa.concat_tables([rest, batch])
            self._check_frames(number, rest.slice(0, told["length"]))
            yield told, rest.slice(0, told["length"])
            rest = rest.slice(told["length"])

    def episode(self, number: int) -> tuple[dict[str, Any], pa.Table]:
        """Reads what is told of one episode, and its frames.

        Raises:
            UserError: there is no such episode, a file is damaged, or numbers of its frames are
                not finite or no poses.
        """
        if not 0 <= number < len(self.episodes):
            raise UserError(
                f"episode is {number}; allowed in {self.folder}: 0 to {len(self.episodes) - 1}"
            )
        told = self.episodes.slice(number, 1).to_pylist()[0]
        path = self.folder / DATA_PATH.format(
            chunk_index=told["data/chunk_index"], file_index=told["data/file_index"]
        )
        with _explained(path):
            frames = pq.read_table(
                path,
                filters=[("episode_index", "=", number)],
                page_checksum_verification=True,
            )
        if len(frames) != told["length"]:
            raise UserError(
                f"{path}: episode {number} has {len(frames)} frames; allowed: {told['length']}"
            )
        _check_no_nulls(path, frames)
        self._check_frames(number, frames)
        return told, frames

    def _check_frames(self, number: int, frames: pa.Table) -> None:
        bad = find_bad_frame(frames, self.features)
        if bad is not None:
            raise UserError(
                f"{self.folder}: {bad.found} in frame {bad.row} of episode {number}; "
                "allowed: what `keypush dataset check` lets pass"
            )


def open_dataset(folder: Path) -> DataSet:
    """Opens a data set.

    Raises:
        UserError: names the file, what was found and what is allowed: it is missing or damaged,
            of another version, has other fields, or counts disagree.
    """
    info = _read_info(folder)
    features = _features(folder / INFO, info)
    episodes = _read_episodes(folder)
    files = _numbered(folder, DATA_PATH)
    frames_per_file = []
    for path in files:
        with _explained(path):
            _check_columns(path, pq.read_schema(path), arrow_schema(features), exact=True)
            frames_per_file.append(pq.read_metadata(path).num_rows)
    dataset = DataSet(folder, features, info["fps"], episodes, files, frames_per_file)
    for name, found, told in (
        ("total_episodes", len(episodes), info["total_episodes"]),
        ("total_frames", dataset.frames, info["total_frames"]),
    ):
        if found != told:
            raise UserError(f"{folder / INFO}: {name} is {told}, but the files have {found}")
    return dataset


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turns what Parquet says of a file into a user's mistake."""
    try:
        yield
    except FileNotFoundError as error:
        # Of a missing file pyarrow tells its name alone.
        raise UserError(f"{path}: is missing; {_ALLOWED}") from error
    except (OSError, pa.ArrowException) as error:
        raise UserError(f"{path}: cannot be read: {one_line(error)}; {_ALLOWED}") from error


def _read_info(folder: Path) -> dict[str, Any]:
    info = _read_json(folder / INFO)
    version = info.get("codebase_version")
    if version != CODEBASE_VERSION:
        raise UserError(
            f"{folder / INFO}: codebase_version is {version!r}; allowed: {CODEBASE_VERSION!r}"
        )
    ours = _read_json(folder / FORMAT).get("format")
    if ours != KEYPUSH_FORMAT:
        raise UserError(f"{folder / FORMAT}: format is {ours!r}; allowed: {KEYPUSH_FORMAT}")
    for name in ("fps", "total_episodes", "total_frames"):
        if not isinstance(info.get(name), int) or info[name] < 1:
            raise UserError(
                f"{folder / INFO}: {name} is {info.get(name)!r}; allowed: whole numbers above 0"
            )
    return info


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read: {one_line(error)}; {_ALLOWED}") from error
    if not isinstance(content, dict):
        raise UserError(f"{path}: holds no JSON object; {_ALLOWED}")
    return content


def _features(path: Path, info: dict[str, Any]) -> tuple[Feature, ...]:
    found = info.get("features")
    if not isinstance(found, dict):
        raise UserError(f"{path}: features is missing; {_ALLOWED}")
    expected: tuple[Feature, ...] = FEATURES
    if CLOUD in found:
        expected = (*FEATURES, cloud_feature(_cloud_points(path, found[CLOUD])))
    for feature in expected:
        entry = found.get(feature.name)
        wanted = {"dtype": feature.dtype, "shape": list(feature.shape)}
        if not isinstance(entry, dict) or any(entry.get(k) != v for k, v in wanted.items()):
            raise UserError(f"{path}: feature {feature.name} is {_brief(entry)}; allowed: {wanted}")
    foreign = sorted(set(found) - {feature.name for feature in expected})
    if foreign:
        raise UserError(f"{path}: features has {', '.join(foreign)}; allowed: those of keypush")
    return expected


def _cloud_points(path: Path, entry: object) -> int:
    shape = entry.get("shape") if isinstance(entry, dict) else None
    if isinstance(shape, list) and len(shape) == 2 and isinstance(shape[0], int) and shape[0] > 0:
        return int(shape[0])
    raise UserError(f"{path}: feature {CLOUD} has shape {shape!r}; allowed: [points, 3]")


def _brief(entry: object) -> object:
    if not isinstance(entry, dict):
        return "missing" if entry is None else repr(entry)[:80]
    return {name: entry.get(name) for name in ("dtype", "shape")}


def _read_episodes(folder: Path) -> pa.Table:
    tables = []
    wanted = pa.schema(
        [*EPISODE_COLUMNS, *(pa.field(name, kind) for name, kind in SUMMARY_TYPES.items())]
    )
    for path in _numbered(folder, EPISODES_PATH):
        with _explained(path):
            schema = pq.read_schema(path)
            _check_columns(path, schema, wanted, exact=False)
            names = [name for name in schema.names if not name.startswith("stats/")]
            table = pq.read_table(path, columns=names, page_checksum_verification=True)
        _check_no_nulls(path, table.select(wanted.names))
        _check_ranges(path, table)
        tables.append(table)
    return pa.concat_tables(tables, promote_options="permissive").combine_chunks()


def _numbered(folder: Path, pattern: str) -> list[Path]:
    files = sorted((folder / pattern.partition("/chunk-")[0]).glob("chunk-*/file-*.parquet"))
    if not files:
        first = folder / pattern.format(chunk_index=0, file_index=0)
        raise UserError(f"{first}: is missing; {_ALLOWED}")
    return files


def _check_columns(path: Path, found: pa.Schema, wanted: pa.Schema, *, exact: bool) -> None:
    for field in wanted:
        position = found.get_field_index(field.name)
        if position < 0:
            raise UserError(f"{path}: column {field.name} is missing; allowed: {field.type}")
        kind = found.field(position).type
        if kind != field.type:
            raise UserError(f"{path}: column {field.name} is {kind}; allowed: {field.type}")
    foreign = sorted(set(found.names) - set(wanted.names))
    if exact and foreign:
        raise UserError(f"{path}: foreign columns: {', '.join(foreign)}; {_ALLOWED}")


def _check_no_nulls(path: Path, table: pa.Table) -> None:
    for name in table.column_names:
        missing = null_count(table[name])
        if missing:
            raise UserError(
                f"{path}: column {name} has no value in {missing} places; allowed: a value in each"
            )


def _check_ranges(path: Path, episodes: pa.Table) -> None:
    ratios = to_array(episodes["size_ratio"])
    fine = np.isfinite(ratios) & (ratios > 0)
    if not fine.all():
        raise UserError(f"{path}: size_ratio is {ratios[~fine][0]:g}; allowed: above 0, finite")
    for name, least in _LEAST.items():
        found = int(to_array(episodes[name]).min(initial=least))
        if found < least:
            raise UserError(f"{path}: {name} is {found}; allowed: from {least}")
