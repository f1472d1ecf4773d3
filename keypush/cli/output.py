"""Output folders: made and proved writable before any work is done."""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from keypush.atomic_file import write_whole
from keypush.errors import UserError

if TYPE_CHECKING:
    from keypush.scenario import Scenario


EVALUATION, REPRODUCTION = "an evaluation", "a reproduction"
DATA_SET, DEMO = "a data set", "a demo"
_MARKS = {
    "job.yaml": EVALUATION,
    "conditions": EVALUATION,
    "tables.md": REPRODUCTION,
    "meta": DATA_SET,
    "collecting": DATA_SET,
}
"""What a folder holds in which there is a file or folder of this name."""


def prepare_output_dir(path: Path, holds: str | None = None) -> Path:
    """Makes a folder, with its parents, and writes a probe into it.

    Permission bits say nothing to root and nothing on read-only file systems, so only a
    real file proves that the folder can be written.

    Args:
        path: the folder.
        holds: what it is going to hold, where that must not get among other results: files of
            the same name would take each other's place.

    Raises:
        UserError: the folder cannot be made or written, or holds something else.
    """
    for mark, held in _MARKS.items():
        if holds not in (None, held) and (path / mark).exists():
            raise UserError(f"output folder {path}: holds {held} ({mark}); allowed: another folder")
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise UserError(
            f"output folder {path}: cannot be written: {error.strerror or error}; "
            "allowed: a folder, new or not, that you may write"
        ) from error
    return path


def write_output(path: Path, content: str | bytes) -> None:
    """Writes a file whole or not at all, and the folders that lead to it.

    Raises:
        UserError: the file cannot be written.
    """
    check_output_file(path)
    write_whole(path, content.encode() if isinstance(content, str) else content)


def check_output_file(path: Path) -> None:
    """Makes the folder of a file, and proves that the file can be written there.

    Raises:
        UserError: it cannot.
    """
    prepare_output_dir(path.parent)
    if path.is_dir():
        raise UserError(f"output file {path}: is a folder; allowed: a file")


def save_scenario(scenario: "Scenario", folder: Path) -> None:
    """Writes the resolved scenario beside the output that it led to.

    Raises:
        UserError: the file cannot be written.
    """
    from keypush.scenario import dump_scenario

    write_output(folder / "scenario.yaml", dump_scenario(scenario))
