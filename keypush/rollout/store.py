"""The folder of a job: its description, and one pair of Parquet files per finished block."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from keypush.atomic_file import TEMPORARY_SUFFIX, write_atomically
from keypush.errors import UserError, one_line
from keypush.rollout.job import Block, Job
from keypush.rollout.shard import Shard, check_shard, shard_columns
from keypush.scenario import dump_scenario


@dataclass(frozen=True)
class Finished:
    """What is known of a finished block."""

    successes: int
    size: int
    """Bytes on disk."""


class EpisodeStore:
    """Reads and writes `rows/` (one row per policy step) and `episodes/` (one per episode).

    A block is finished when both of its files stand; that in `episodes/` is written last.
    """

    def __init__(self, folder: Path) -> None:
        """Args: the job's folder, which exists."""
        self.folder = folder
        self._rows = folder / "rows"
        self._episodes = folder / "episodes"
        self._columns: tuple[pa.Schema, list[str]] | None = None

    def open(self, job: Job) -> dict[Block, Finished]:
        """Makes the folder ready for a job, new or to be resumed.

        Returns:
            The blocks that are finished, each checked.

        Raises:
            UserError: the folder holds another job, a damaged file or one of something else,
                or cannot be written; names the file, and the first field that differs.
        """
        try:
            _write_description(job, self.folder)
            self._rows.mkdir(exist_ok=True)
            self._episodes.mkdir(exist_ok=True)
        except OSError as error:
            raise self._unwritable(self.folder, error) from error
        compare_description(job, self.folder)
        self.discard_partial_files()
        blocks = {f"{block.name}.parquet": block for block in job.blocks()}
        self._refuse_strangers(set(blocks))
        return {
            block: self._check(block, job.scenario.seed)
            for name, block in blocks.items()
            if (self._episodes / name).exists() and (self._rows / name).exists()
        }

    def write(self, block: Block, shard: Shard) -> None:
        """Writes a finished block.

        Raises:
            UserError: the disk is full or fails, or the folder's shards have other columns;
                what was written before is kept.
        """
        rows, episodes = self._paths(block)
        columns = shard_columns(pa.BufferReader(shard.rows), pa.BufferReader(shard.episodes))
        self._compare_columns(rows, columns)
        for content, path in ((shard.rows, rows), (shard.episodes, episodes)):
            try:
                write_atomically(content, path)
            except OSError as error:
                raise self._unwritable(path, error) from error

    def read_summaries(self) -> list[dict[str, Any]]:
        """Reads the summaries of all finished episodes, by object and episode."""
        tables = [pq.read_table(path) for path in sorted(self._episodes.glob("*.parquet"))]
        if not tables:
            return []
        summaries: list[dict[str, Any]] = pa.concat_tables(
            tables, promote_options="permissive"
        ).to_pylist()
        return summaries

    def discard_partial_files(self) -> None:
        """Removes what a run left that was stopped while it wrote."""
        for folder in (self.folder, self._rows, self._episodes):
            for path in folder.glob(f".*{TEMPORARY_SUFFIX}"):
                path.unlink(missing_ok=True)

    def kept(self) -> str:
        """Says, for a message, what is there already."""
        count = sum(1 for _ in self._episodes.glob("*.parquet"))
        return f"{count} finished blocks are kept in {self.folder}"

    def _paths(self, block: Block) -> tuple[Path, Path]:
        name = f"{block.name}.parquet"
        return self._rows / name, self._episodes / name

    def _check(self, block: Block, seed: int) -> Finished:
        rows, episodes = self._paths(block)
        successes = check_shard(rows, episodes, block, seed)
        self._compare_columns(rows, shard_columns(rows, episodes))
        return Finished(successes, rows.stat().st_size + episodes.stat().st_size)

    def _compare_columns(self, path: Path, columns: tuple[pa.Schema, list[str]]) -> None:
        """Compares with the first shard: keypush may change without a new version."""
        if self._columns is None:
            self._columns = columns
        if columns != self._columns:
            names = [{*schema.names, *more} for schema, more in (columns, self._columns)]
            other = ", ".join(sorted(names[0] ^ names[1])) or "other types"
            raise UserError(
                f"{path}: its columns are not those of the files beside it ({other}); "
                f"allowed: another output folder; {self.kept()}"
            )

    def _refuse_strangers(self, names: set[str]) -> None:
        for folder in (self._rows, self._episodes):
            for path in sorted(folder.glob("*.parquet")):
                if path.name not in names:
                    raise UserError(f"{path}: is no part of this job; allowed: its blocks alone")

    def _unwritable(self, path: Path, error: OSError) -> UserError:
        return UserError(
            f"{path}: cannot be written: {error.strerror or one_line(error)}; {self.kept()}, "
            "and the same command goes on from them"
        )


def compare_description(job: Job, folder: Path) -> None:
    """Compares scenario.yaml and job.yaml of a folder with a job.

    Raises:
        UserError: they are of another job, missing or no YAML; names the first field that
            differs.
    """
    for name, text in _description(job).items():
        _compare(folder / name, text)


def _write_description(job: Job, folder: Path) -> None:
    for name, text in _description(job).items():
        if not (folder / name).exists():
            write_atomically(text.encode(), folder / name)


def _description(job: Job) -> dict[str, str]:
    return {
        "scenario.yaml": dump_scenario(job.scenario),
        "job.yaml": yaml.safe_dump(job.describe(), sort_keys=False),
    }


def _compare(path: Path, text: str) -> None:
    try:
        found = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, yaml.YAMLError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: cannot be read: {one_line(error)}") from error
    field = _first_difference(found, yaml.safe_load(text))
    if field is not None:
        raise UserError(
            f"{path}: {field[0]} is {field[1]!r} there and {field[2]!r} now; "
            "allowed: the same job, or another output folder"
        )


def _first_difference(found: Any, wanted: Any, name: str = "") -> tuple[str, Any, Any] | None:
    if not (isinstance(found, dict) and isinstance(wanted, dict)):
        return None if found == wanted else (name or "the content", found, wanted)
    for key in [*found, *(key for key in wanted if key not in found)]:
        inner = _first_difference(found.get(key), wanted.get(key), f"{name}.{key}".lstrip("."))
        if inner is not None:
            return inner
    return None
