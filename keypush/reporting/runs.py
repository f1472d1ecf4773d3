"""What lies in the folders that a report is made of: records and recordings."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import pyarrow as pa

from keypush.errors import UserError
from keypush.evaluation.records import RECORDS_FILE, read_records

RUN = "run"
"""Name of the column that says, as it was given, which folder an episode comes from."""
_ALLOWED = "allowed: a folder that `keypush evaluate` or `keypush reproduce` has finished"
_RECORDINGS = "**/recordings/*.html"


class Recording(NamedTuple):
    """A recorded episode that a page can link to."""

    name: str
    """Its file's name without the ending."""
    group: str
    """The folder that its folder of recordings lies in, relative to the page."""
    address: str
    """Its address, relative to the page."""


def read_runs(runs: Sequence[Path]) -> pa.Table:
    """Reads the records of several folders.

    Returns:
        Rows of `RECORDS` in the folders' order, with the column `RUN`.

    Raises:
        UserError: a folder has no records or damaged ones, or nowhere is an episode.
    """
    tables = [_read(run) for run in runs]
    table = pa.concat_tables(tables)
    if not len(table):
        raise UserError(f"{', '.join(map(str, runs))}: no episode was recorded; {_ALLOWED}")
    return table


def _read(run: Path) -> pa.Table:
    path = run / RECORDS_FILE
    if not path.is_file():
        raise UserError(f"{run}: holds no {RECORDS_FILE}; {_ALLOWED}")
    table = read_records(path)
    return table.append_column(RUN, pa.array([str(run)] * len(table), pa.string()))


def find_recordings(runs: Sequence[Path], page: Path) -> list[Recording]:
    """Finds recorded episodes: `recordings/*.html` in a folder, or in any folder within it.

    Args:
        runs: the folders.
        page: where the page that links to them is going to be.
    """
    base = page.resolve().parent
    found = {path.resolve(): None for run in runs for path in sorted(run.glob(_RECORDINGS))}
    return [
        Recording(
            name=_shown(path.stem),
            group=_shown(_relative(path.parent.parent, base)),
            address=quote(os.fsencode(_relative(path, base))),
        )
        for path in found
    ]


def _relative(path: Path, base: Path) -> str:
    return Path(os.path.relpath(path, base)).as_posix()


def _shown(name: str) -> str:
    """A file's name may be no Unicode, a page has to be."""
    return name.encode(errors="backslashreplace").decode()
