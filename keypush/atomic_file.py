"""Files that are written whole or not at all, and the folders for them."""

import os
from pathlib import Path

from keypush.errors import UserError, one_line

TEMPORARY_SUFFIX = ".partial"


def write_atomically(content: bytes, path: Path) -> None:
    """Writes a file beside `path` and renames it.

    Under its name a file is whole, also after a loss of power. What is there and is no file, such
    as /dev/stdout, is written to and not replaced.

    Raises:
        OSError: the file cannot be written. Nothing is left of it, nor where Ctrl-C interrupts.
    """
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    partial = path.with_name(f".{path.name}.{os.getpid()}{TEMPORARY_SUFFIX}")
    try:
        with partial.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def write_whole(path: Path, content: bytes) -> None:
    """Writes a file of results as `write_atomically` does, and its folder where it is missing.

    Raises:
        UserError: the file cannot be written; names it.
    """
    make_folder(path.parent)
    try:
        write_atomically(content, path)
    except OSError as error:
        reason = error.strerror or one_line(error)
        raise UserError(f"{path}: cannot be written: {reason}") from error


def make_folder(path: Path) -> None:
    """Makes a folder of results, with its parents, where it is missing.

    Raises:
        UserError: it cannot be made; names it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{path}: cannot be made: {error.strerror or one_line(error)}") from error
