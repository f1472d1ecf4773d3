"""Episodes of blocks that are not finished: a pair of files each, joined when the block is."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from keypush.atomic_file import write_atomically
from keypush.rollout.job import Block
from keypush.rollout.parquet import parquet_bytes
from keypush.rollout.shard import Shard


@dataclass(frozen=True)
class Pair:
    """Two files of the same episodes; they are there when that in `episodes/` is, the last one."""

    rows: Path
    episodes: Path

    @staticmethod
    def of(folder: Path, block: Block) -> "Pair":
        """Those of a block in a folder."""
        name = f"{block.name}.parquet"
        return Pair(folder / "rows" / name, folder / "episodes" / name)

    @property
    def exists(self) -> bool:
        """Whether both stand."""
        return self.episodes.exists() and self.rows.exists()

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return self.rows.stat().st_size + self.episodes.stat().st_size

    def write(self, shard: Shard) -> None:
        """Writes both.

        Raises:
            OSError: the disk is full or fails.
        """
        self.rows.parent.mkdir(parents=True, exist_ok=True)
        self.episodes.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(shard.rows, self.rows)
        write_atomically(shard.episodes, self.episodes)

    def remove(self) -> None:
        """Removes what is there."""
        self.episodes.unlink(missing_ok=True)
        self.rows.unlink(missing_ok=True)


def join(pairs: Iterable[Pair]) -> Shard:
    """Makes one shard of files that follow each other."""
    rows, episodes = zip(*((pair.rows, pair.episodes) for pair in pairs), strict=True)
    summaries = _join(episodes)
    return Shard(
        rows=parquet_bytes(_join(rows)),
        episodes=parquet_bytes(summaries),
        successes=sum(summaries["success"].to_pylist()),
    )


def _join(paths: Iterable[Path]) -> pa.Table:
    """Joins tables; a column that is null in one of them has the type of the others."""
    tables = [pq.read_table(path) for path in paths]
    return pa.concat_tables(tables, promote_options="permissive").combine_chunks()
