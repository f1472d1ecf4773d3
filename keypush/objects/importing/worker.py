"""The process that reads files: limited, silent, and beyond the reach of Ctrl-C."""

import os
import resource
import sys
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from keypush.errors import UserError, one_line
from keypush.objects.importing.steps import Done, Draft, import_steps

MEMORY_LIMIT = 8 * 1024**3
"""Address space in bytes."""


@dataclass(frozen=True)
class Refused:
    """The file is refused, with this line."""

    text: str


Message = Draft | Done | Refused


def serve(connection: Connection) -> None:
    """Imports files that are sent as (path, time limit in s) until the connection closes."""
    _silence()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))
    # A library that crashes is expected here and reported by the parent.
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        while True:
            path, time_limit = connection.recv()
            _limit_processor_time(time_limit)
            _import(connection, path)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def _import(connection: Connection, path: Path) -> None:
    try:
        for step in import_steps(path):
            connection.send(step)
    except UserError as error:
        connection.send(Refused(str(error)))
    except MemoryError:
        connection.send(
            Refused(f"{path}: reading it needs more than {MEMORY_LIMIT / 1024**3:.0f} GB of memory")
        )
    except (BrokenPipeError, ConnectionResetError):
        raise
    except Exception as error:
        # Readers raise anything at all about contents that they did not expect.
        text = one_line(error)
        # A single word, such as a missing key, says nothing by itself.
        what = text if " " in text else f"{type(error).__name__} {text}".rstrip()
        connection.send(Refused(f"{path}: cannot be read as a mesh: {what}"))


def _limit_processor_time(seconds: float) -> None:
    """Ends this process even if its parent was killed and can no longer do so."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    limit = int(usage.ru_utime + usage.ru_stime + seconds) + 2
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, hard))


def _silence() -> None:
    """Sends what libraries print, in Python or not, nowhere."""
    sys.stdout.flush()
    sys.stderr.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    os.close(nowhere)
