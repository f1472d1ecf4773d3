"""The entry point of the `keypush` command."""

import errno
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro
from tyro.conf import subcommand

from keypush import __version__
from keypush.cli.ablate import Ablate
from keypush.cli.bench import Bench
from keypush.cli.collect import Collect
from keypush.cli.dataset import Dataset
from keypush.cli.demo import Demo
from keypush.cli.diagram import Diagram
from keypush.cli.evaluate import Evaluate
from keypush.cli.objects import Objects
from keypush.cli.pretrain import Pretrain
from keypush.cli.report import Report
from keypush.cli.reproduce import Reproduce
from keypush.cli.train import Train
from keypush.errors import UserError

Verb = (
    Annotated[Demo, subcommand("demo")]
    | Annotated[Collect, subcommand("collect")]
    | Annotated[Dataset, subcommand("dataset")]
    | Annotated[Pretrain, subcommand("pretrain")]
    | Annotated[Train, subcommand("train")]
    | Annotated[Ablate, subcommand("ablate")]
    | Annotated[Evaluate, subcommand("evaluate")]
    | Annotated[Report, subcommand("report")]
    | Annotated[Reproduce, subcommand("reproduce")]
    | Annotated[Objects, subcommand("objects")]
    | Annotated[Bench, subcommand("bench")]
    | Annotated[Diagram, subcommand("diagram")]
)

_UNUSABLE = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENAMETOOLONG, errno.ELOOP)
"""What the system says of a path that somebody mistook; all other errors are bugs."""
_DESCRIPTION = """Push unseen objects through one predicted contact keypoint, in Drake.

A first look: keypush demo. Every verb explains itself: keypush VERB --help.
keypush --version prints the version."""


def main(arguments: list[str] | None = None) -> int:
    """Runs one verb.

    Args:
        arguments: the command line without the program's name; None: that of the process.

    Returns:
        The exit status: 0; 1 where a check failed, 2 after a mistake of the user's, 130 after
        Ctrl-C.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments == ["--version"]:
        print(f"keypush {__version__}")
        return 0
    try:
        _check_words(arguments)
    except UserError as error:
        return _refuse(str(error))
    verb = tyro.cli(
        Verb,
        prog="keypush",
        description=_DESCRIPTION,
        args=arguments or ["--help"],
        config=(tyro.conf.FlagCreatePairsOff, tyro.conf.DisallowNone),
    )
    try:
        status = verb.run()
    except UserError as error:
        return _refuse(str(error))
    except OSError as error:
        if error.errno not in _UNUSABLE or error.filename is None:
            raise
        return _refuse(f"{error.filename}: {error.strerror}; allowed: a path that you may use")
    except KeyboardInterrupt:
        print(f"\nkeypush: stopped; {verb.after_interrupt}", file=sys.stderr)
        return 130
    return status or 0


def _check_words(arguments: Sequence[str]) -> None:
    """Refuses what is no Unicode, as results tell of files and policies by their names."""
    for word in arguments:
        shown = word.encode(errors="backslashreplace").decode()
        if shown != word:
            raise UserError(f"{shown}: is not UTF-8; allowed: names that are")


def _refuse(reason: str) -> int:
    print(f"keypush: {reason}", file=sys.stderr)
    return 2
