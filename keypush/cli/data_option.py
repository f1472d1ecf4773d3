"""The option `--data`, a data set's folder."""

from pathlib import Path

from keypush.errors import UserError


def check_data(data: Path) -> None:
    """Checks that a folder is there.

    Raises:
        UserError: it is not.
    """
    if not data.is_dir():
        raise UserError(f"--data {data}: no such folder; allowed: one of `keypush collect`")
