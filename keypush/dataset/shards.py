"""The finished shards of a job, in the order of its objects and episodes."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from keypush.dataset.job_file import read_job, read_yaml
from keypush.errors import UserError, one_line

_ALLOWED = "allowed: the folder of a finished job"


@dataclass(frozen=True)
class Shards:
    """A job's folder: scenario.yaml, job.yaml, and rows/ and episodes/ with a file per block."""

    folder: Path
    objects: list[str]
    episodes: int
    """Per object, numbered from 0."""

    @classmethod
    def open(cls, folder: Path) -> "Shards":
        """Reads what the job is.

        Raises:
            UserError: the folder holds no job.
        """
        objects, episodes = read_job(folder / "job.yaml")
        return cls(folder, objects, episodes)

    def scenario(self) -> dict[str, Any]:
        """Reads the scenario, as YAML has it."""
        return read_yaml(self.folder / "scenario.yaml")

    def blocks(self) -> Iterator[tuple[pa.Table, pa.Table]]:
        """Yields the summaries of each block's episodes and their rows, both by episode.

        Raises:
            UserError: an episode is missing, or a file is missing, damaged or disagrees.
        """
        for name in self.objects:
            expected = 0
            for path in self._files(name):
                episodes = _read_parquet(path).sort_by("episode")
                rows = _read_parquet(self.folder / "rows" / path.name)
                found = episodes["episode"].to_pylist()
                if found != list(range(expected, expected + len(found))):
                    raise UserError(f"{path}: episode {expected} of {name} is missing; {_ALLOWED}")
                if set(rows["episode"].unique().to_pylist()) != set(found):
                    raise UserError(f"{path.name}: rows/ and episodes/ disagree; {_ALLOWED}")
                expected += len(found)
                yield episodes, rows.sort_by([("episode", "ascending"), ("step", "ascending")])
            if expected != self.episodes:
                raise UserError(
                    f"shards {self.folder}: {expected} of {self.episodes} episodes of {name} "
                    f"are there; {_ALLOWED}"
                )

    def _files(self, name: str) -> list[Path]:
        pattern = re.compile(re.escape(name) + r"-\d+\.parquet")
        return sorted(p for p in (self.folder / "episodes").glob("*") if pattern.fullmatch(p.name))


def _read_parquet(path: Path) -> pa.Table:
    try:
        return pq.read_table(path, page_checksum_verification=True)
    except (OSError, pa.ArrowException) as error:
        raise UserError(f"{path}: cannot be read: {one_line(error)}; {_ALLOWED}") from error
