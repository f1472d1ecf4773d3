"""The folder of a job: its description, and one pair of Parquet files per finished block."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from keypush.errors import UserError
from keypush.rollout.job import Block, Job
from keypush.rollout.parquet import (
    TEMPORARY_SUFFIX,
    Rows,
    table_from_rows,
    table_from_summaries,
    write_atomically,
)
from keypush.scenario import dump_scenario


class EpisodeStore:
    """Reads and writes `rows/` (one row per policy step) and `episodes/` (one per episode).

    A block is finished when its file in `episodes/` stands: that is written last.
    """

    def __init__(self, folder: Path) -> None:
        """Args: the job's folder, which exists."""
        self._folder = folder
        self._rows = folder / "rows"
        self._episodes = folder / "episodes"

    def open(self, job: Job) -> None:
        """Makes the folder ready for a job, new or to be resumed.

        Raises:
            UserError: the folder holds another job; names the first field that differs.
        """
        self._agree("scenario.yaml", dump_scenario(job.scenario))
        self._agree("job.yaml", yaml.safe_dump(job.describe(), sort_keys=False))
        self._rows.mkdir(exist_ok=True)
        self._episodes.mkdir(exist_ok=True)
        self.discard_partial_files()

    def is_finished(self, block: Block) -> bool:
        """Whether the block has been written."""
        return (self._episodes / f"{block.name}.parquet").exists()

    def write(
        self, block: Block, rows: Sequence[Rows], summaries: Sequence[Mapping[str, object]]
    ) -> None:
        """Writes a finished block: for each of its episodes the rows and the summary."""
        write_atomically(table_from_rows(rows), self._rows / f"{block.name}.parquet")
        write_atomically(table_from_summaries(summaries), self._episodes / f"{block.name}.parquet")

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
        """Removes what workers left that were stopped while they wrote."""
        for folder in (self._rows, self._episodes):
            for path in folder.glob(f".*{TEMPORARY_SUFFIX}"):
                path.unlink()

    def _agree(self, name: str, text: str) -> None:
        path = self._folder / name
        if not path.exists():
            path.write_text(text, encoding="utf-8")
            return
        found, wanted = yaml.safe_load(path.read_text(encoding="utf-8")), yaml.safe_load(text)
        field = _first_difference(found, wanted)
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
