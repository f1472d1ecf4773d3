"""Runs a script: the parameters of its `main` are its arguments, a user's mistake is one line."""

import sys
from collections.abc import Callable
from pathlib import Path

import tyro

from keypush.errors import UserError


def as_command(main: Callable[..., None]) -> None:
    """Calls `main` with what the command line says; exits with status 2 after a mistake."""
    told = sys.modules[main.__module__].__doc__
    try:
        tyro.cli(main, description=told, config=(tyro.conf.PositionalRequiredArgs,))
    except UserError as error:
        print(f"{Path(sys.argv[0]).stem}: {error}", file=sys.stderr)
        sys.exit(2)


def check_names(what: str, names: tuple[str, ...], allowed: list[str]) -> None:
    """Checks that all names are known.

    Raises:
        UserError: one is not.
    """
    for name in names:
        if name not in allowed:
            raise UserError(f"{what} is {name!r}; allowed: {', '.join(allowed)}")
