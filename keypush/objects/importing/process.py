"""Imports a mesh file in a process of its own, which may hang, crash or run out of memory."""

import multiprocessing
import os
import signal
import time
from dataclasses import replace
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from typing import Self

from keypush.errors import UserError
from keypush.objects.importing.read import check_file
from keypush.objects.importing.result import ImportedMesh
from keypush.objects.importing.steps import Draft
from keypush.objects.importing.worker import Message, Refused, serve
from keypush.worker_environment import worker_environment

REPAIR_SECONDS = 8.0
"""After this the convex hull has to do."""
_STOP_SECONDS = 5.0
_LOOK_SECONDS = 0.02
_MOST_WALL = 10.0
"""A process that is given so many times the wall time hangs, or waits for something."""
_TICKS = os.sysconf("SC_CLK_TCK")


def import_mesh(path: Path, time_limit: float = 60.0) -> ImportedMesh:
    """Makes a closed solid of a mesh file.

    Args:
        path: OBJ, STL, PLY, GLB, glTF or OFF.
        time_limit: s of processor time for all of it, so that what becomes of a file does not
            depend on what else the machine does; reading a million faces takes about 20.

    Raises:
        UserError: one line that names the file, what was found and what is allowed.
    """
    with Importer() as importer:
        return importer.import_mesh(path, time_limit)


class Importer:
    """A process that imports one file after the other; a new one is started when it dies."""

    def __init__(self, repair_seconds: float = REPAIR_SECONDS) -> None:
        """Args: processor time in s after which the convex hull has to do."""
        self._repair_seconds = repair_seconds
        self._process: SpawnProcess | None = None
        self._connection: Connection | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        """Ends the process."""
        self._stop()

    def import_mesh(self, path: Path, time_limit: float = 60.0) -> ImportedMesh:
        """Does what the function `import_mesh` does."""
        check_file(path)
        connection = self._start()
        begun = self._processor_time()
        connection.send((path, time_limit))
        first = self._receive(connection, time_limit)
        if isinstance(first, Refused):
            raise UserError(first.text)
        if isinstance(first, str):
            raise UserError(f"{path}: cannot be read as a mesh: reading it {first}")
        if not isinstance(first, Draft):
            return first.result
        left = time_limit - (self._processor_time() - begun)
        last = self._receive(connection, min(left, self._repair_seconds))
        if isinstance(last, str):
            notes = (*first.result.notes, f"repairing it {last}")
            return replace(first.result, notes=notes)
        if isinstance(last, Refused):
            notes = (*first.result.notes, "repairing it failed")
            return replace(first.result, notes=notes)
        return last.result

    def _start(self) -> Connection:
        if self._connection is not None:
            return self._connection
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs,), daemon=True)
        with worker_environment():
            process.start()
        theirs.close()
        self._process, self._connection = process, ours
        return ours

    def _stop(self) -> None:
        if self._process is None or self._connection is None:
            return
        self._process.terminate()
        self._process.join(_STOP_SECONDS)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._connection.close()
        self._process = self._connection = None

    def _receive(self, connection: Connection, seconds: float) -> Message | str:
        """Returns the next message, or in words why none came, and then stops the process."""
        begun, hangs = self._processor_time(), time.monotonic() + _MOST_WALL * max(seconds, 1.0)
        try:
            while not connection.poll(_LOOK_SECONDS):
                if self._processor_time() - begun >= seconds or time.monotonic() > hangs:
                    break
            else:
                message: Message = connection.recv()
                return message
            why = f"took longer than {max(seconds, 0.0):.0f} s"
        except (EOFError, ConnectionResetError):
            why = f"crashed a library ({self._cause()})"
        self._stop()
        return why

    def _processor_time(self) -> float:
        """Time that the process has had of a processor, s."""
        assert self._process is not None
        try:
            stat = Path(f"/proc/{self._process.pid}/stat").read_bytes()
        except OSError:  # gone, which its connection tells
            return 0.0
        # Source: proc_pid_stat(5), utime and stime; what stands before may have any name.
        user, system = stat.rpartition(b")")[2].split()[11:13]
        return (int(user) + int(system)) / _TICKS

    def _cause(self) -> str:
        if self._process is None:
            return "process gone"
        self._process.join(_STOP_SECONDS)
        status = self._process.exitcode
        return signal.Signals(-status).name if status and status < 0 else f"exit status {status}"
