"""The folder of a job: its description, and a pair of Parquet files per block or per episode."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from keypush.atomic_file import TEMPORARY_SUFFIX, write_atomically
from keypush.errors import UserError, one_line
from keypush.rollout.job import Block, Job, runs
from keypush.rollout.shard import Shard, check_shard, shard_columns
from keypush.rollout.unfinished import Pair, join
from keypush.scenario import dump_scenario
from keypush.yaml_text import parse_yaml

_KINDS = ("rows", "episodes")
_PARTIAL = f".*{TEMPORARY_SUFFIX}"
_UNFINISHED = "unfinished"


@dataclass
class Found:
    """What is finished of a job, and what is not."""

    missing: list[Block] = field(default_factory=list)
    """Blocks, or what is left of them."""
    episodes: int = 0
    successes: int = 0
    size: int = 0
    """Bytes on disk."""


class EpisodeStore:
    """Reads and writes `rows/` (one row per policy step) and `episodes/` (one per episode).

    A block is finished when both of its files stand; that in `episodes/` is written last. Until
    then each of its episodes has such a pair in `unfinished/`, so that a stop loses none.
    """

    def __init__(self, folder: Path) -> None:
        """Args: the job's folder, which exists."""
        self.folder = folder
        self._unfinished = folder / _UNFINISHED
        self._block_of: dict[Block, Block] = {}
        self._columns: tuple[pa.Schema, list[str]] | None = None

    def open(self, job: Job, index: int = 0) -> Found:
        """Makes the folder ready for a job, new or to be resumed.

        Args:
            job: whose folder it is.
            index: of the job among those that run together.

        Returns:
            What is there, all of it checked.

        Raises:
            UserError: the folder holds another job, a damaged file or one of something else,
                or cannot be written; names the file, and the first field that differs.
        """
        try:
            if not self._has_episodes():
                _write_description(job, self.folder)
            for name in _KINDS:
                (self.folder / name).mkdir(exist_ok=True)
        except OSError as error:
            raise self._unwritable(self.folder, error) from error
        compare_description(job, self.folder)
        self._discard_partial_files()
        blocks = list(job.blocks(index))
        self._block_of = {episode: block for block in blocks for episode in block.each()}
        self._refuse_strangers(self.folder, blocks)
        self._refuse_strangers(self._unfinished, self._block_of)
        found = Found()
        for block in blocks:
            self._look_for(block, job.scenario.seed, found)
        return found

    def write(self, episode: Block, shard: Shard) -> None:
        """Writes a finished episode; with the last one of its block, the block.

        Args:
            episode: a block of one.
            shard: its content.

        Raises:
            UserError: the disk is full or fails, or the folder's shards have other columns;
                what was written before is kept.
        """
        pair = Pair.of(self._unfinished, episode)
        columns = shard_columns(pa.BufferReader(shard.rows), pa.BufferReader(shard.episodes))
        self._compare_columns(pair.rows, columns)
        self._write(pair, shard)
        self._finish(self._block_of[episode])

    def read_summaries(self) -> list[dict[str, Any]]:
        """Reads the summaries of all finished episodes, by object and episode."""
        folder = self.folder / "episodes"
        tables = [pq.read_table(path) for path in sorted(folder.glob("*.parquet"))]
        if not tables:
            return []
        summaries: list[dict[str, Any]] = pa.concat_tables(
            tables, promote_options="permissive"
        ).to_pylist()
        return summaries

    def kept(self) -> str:
        """Says, for a message, what is there already."""
        return f"finished episodes are kept in {self.folder}"

    def _has_episodes(self) -> bool:
        """Whether anything was run already, so that its description cannot be written anew."""
        places = (self.folder, self._unfinished)
        return any(any((place / name).glob("*.parquet")) for place in places for name in _KINDS)

    def _look_for(self, block: Block, seed: int, found: Found) -> None:
        """Adds what is there of a block, and what is not."""
        whole = Pair.of(self.folder, block)
        if whole.exists:
            self._check(block, whole, seed, found)
            self._discard_episodes(block)
            return
        missing = []
        for episode in block.each():
            pair = Pair.of(self._unfinished, episode)
            if pair.exists:
                self._check(episode, pair, seed, found)
            else:
                missing.append(episode)
        if missing:
            found.missing.extend(runs(missing))
        else:
            self._finish(block)

    def _check(self, block: Block, pair: Pair, seed: int, found: Found) -> None:
        found.successes += check_shard(pair.rows, pair.episodes, block, seed)
        self._compare_columns(pair.rows, shard_columns(pair.rows, pair.episodes))
        found.episodes += block.count
        found.size += pair.size

    def _finish(self, block: Block) -> None:
        """Joins the episodes of a block, if all are there."""
        pairs = [Pair.of(self._unfinished, episode) for episode in block.each()]
        if all(pair.exists for pair in pairs):
            self._write(Pair.of(self.folder, block), join(pairs))
            self._discard_episodes(block)

    def _write(self, pair: Pair, shard: Shard) -> None:
        try:
            pair.write(shard)
        except OSError as error:
            raise self._unwritable(pair.rows, error) from error

    def _discard_episodes(self, block: Block) -> None:
        for episode in block.each():
            Pair.of(self._unfinished, episode).remove()
        for folder in (*(self._unfinished / name for name in _KINDS), self._unfinished):
            with suppress(OSError):  # Another block has episodes there.
                folder.rmdir()

    def _discard_partial_files(self) -> None:
        """Removes what a run left that was stopped while it wrote."""
        for path in [*self.folder.glob(_PARTIAL), *self.folder.glob(f"*/{_PARTIAL}"),
                     *self._unfinished.glob(f"*/{_PARTIAL}")]:  # fmt: skip
            path.unlink(missing_ok=True)

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

    def _refuse_strangers(self, folder: Path, blocks: Iterable[Block]) -> None:
        names = {f"{block.name}.parquet" for block in blocks}
        for kind in _KINDS:
            for path in sorted((folder / kind).glob("*.parquet")):
                if path.name not in names:
                    raise UserError(f"{path}: is no part of this job; allowed: its blocks alone")

    def _unwritable(self, path: Path, error: OSError) -> UserError:
        return UserError(
            f"{path}: cannot be written: {error.strerror or one_line(error)}; {self.kept()}, "
            "and the same command goes on from them"
        )


def finished_episodes(job: Job, folder: Path) -> int:
    """Counts the episodes of a job whose files stand, in blocks and single ones, unchecked."""
    return sum(_finished(block, folder) for block in job.blocks())


def _finished(block: Block, folder: Path) -> int:
    if Pair.of(folder, block).exists:  # A stop may have left its episodes beside it.
        return block.count
    return sum(Pair.of(folder / _UNFINISHED, episode).exists for episode in block.each())


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
        found = parse_yaml(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, UserError) as error:
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
