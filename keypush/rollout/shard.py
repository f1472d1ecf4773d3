"""Two Parquet files: made of an episode, joined to those of a block, checked when a job resumes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from keypush.errors import UserError, one_line
from keypush.rollout.episode import EpisodeResult
from keypush.rollout.job import Block
from keypush.rollout.parquet import parquet_bytes, table_from_rows, table_from_summaries

_EPISODE_KEYS = ["object", "seed", "episode", "success", "steps"]
_ROW_KEYS = ["object", "seed", "episode", "step"]


@dataclass(frozen=True)
class Shard:
    """Finished episodes as the contents of their files."""

    rows: bytes
    """Parquet: one row per policy step."""
    episodes: bytes
    """Parquet: one row per episode."""
    successes: int

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return len(self.rows) + len(self.episodes)


def make_shard(result: EpisodeResult) -> Shard:
    """Makes the files of an episode."""
    return Shard(
        rows=parquet_bytes(table_from_rows([result.rows])),
        episodes=parquet_bytes(table_from_summaries([result.summary])),
        successes=int(bool(result.summary["success"])),
    )


def check_shard(rows: Path, episodes: Path, block: Block, seed: int) -> int:
    """Checks that two files hold what a block should, undamaged.

    Returns:
        The number of episodes that succeeded.

    Raises:
        UserError: a file cannot be read, lacks a column, or holds other episodes; names it.
    """
    summaries = read_shard(episodes, _EPISODE_KEYS)
    numbers = range(block.first, block.first + block.count)
    found = [(s["object"], s["seed"], s["episode"]) for s in summaries.to_pylist()]
    if found != [(block.object, seed, number) for number in numbers]:
        raise _damaged(episodes, f"holds other episodes than {block}")
    keys = read_shard(rows, _ROW_KEYS)
    steps = summaries["steps"].to_pylist()
    if not _rows_agree(keys, block, seed, steps):
        raise _damaged(rows, f"holds other rows than those of {block}")
    return sum(summaries["success"].to_pylist())


def read_shard(path: Path, columns: Sequence[str]) -> pa.Table:
    """Reads a file of a shard, all of it, so that damage anywhere is found.

    Args:
        path: the file.
        columns: that it must have; it may have more.

    Raises:
        UserError: it cannot be read, a checksum is wrong, or it lacks a column; names it.
    """
    try:
        table = pq.read_table(path, page_checksum_verification=True)
    # A damaged footer may hold names that are no text.
    except (OSError, ValueError, pa.ArrowException) as error:
        raise _damaged(path, f"cannot be read: {one_line(error)}") from error
    missing = set(columns) - set(table.column_names)
    if missing:
        raise _damaged(path, f"lacks the columns {', '.join(sorted(missing))}")
    return table


def shard_columns(rows: Any, episodes: Any) -> tuple[pa.Schema, list[str]]:
    """Returns what all shards of a folder share: schema of the rows, columns of the episodes.

    Args:
        rows: a path or a buffer that pyarrow reads.
        episodes: the same.
    """
    return pq.read_schema(rows), pq.read_schema(episodes).names


def _rows_agree(keys: pa.Table, block: Block, seed: int, steps: list[int]) -> bool:
    """Whether the episodes follow each other, each with steps 0, 1, ... beyond its `steps`."""
    of_object = keys["object"].unique().to_pylist() == [block.object]
    if not of_object or keys["seed"].unique().to_pylist() != [seed]:
        return False
    episode, step = keys["episode"].to_numpy(), keys["step"].to_numpy()
    starts = np.flatnonzero(np.diff(episode, prepend=episode[0] - 1))
    lengths = np.diff(starts, append=len(episode))
    whole = np.concatenate([np.arange(n) for n in lengths])
    return (
        episode[starts].tolist() == list(range(block.first, block.first + block.count))
        and np.array_equal(step, whole)
        and bool(np.all(lengths >= steps))
    )


def _damaged(path: Path, found: str) -> UserError:
    return UserError(
        f"{path}: {found}; allowed: the file that this job wrote, or none, to run it again"
    )
