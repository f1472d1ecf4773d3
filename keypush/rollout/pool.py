"""Long-lived worker processes that Ctrl-C, a crash or the end of the parent cannot orphan."""

import multiprocessing
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from types import TracebackType
from typing import Self

from keypush.errors import UserError
from keypush.rollout.job import Block
from keypush.rollout.worker import Failed, MakeRunner, Message, work
from keypush.scenario import Scenario

_STOP_SECONDS = 5.0


@dataclass
class Worker:
    """A process and what it does."""

    process: SpawnProcess
    connection: Connection
    block: Block | None = None
    """The block under way."""
    object: str = ""
    """The object whose diagram it holds."""

    def start(self, block: Block) -> None:
        """Hands it a block."""
        self.block, self.object = block, block.object
        self.connection.send(block)


class WorkerPool:
    """Starts workers on entry and ends them, at once, on exit."""

    def __init__(
        self, count: int, scenario: Scenario, folder: Path, make_runner: MakeRunner
    ) -> None:
        """Args: number of processes, and what every worker is given."""
        self._count = count
        self._arguments = (scenario, folder, make_runner)
        self.workers: list[Worker] = []

    def __enter__(self) -> Self:
        """Starts the processes."""
        context = multiprocessing.get_context("spawn")
        with _worker_environment():
            for _ in range(self._count):
                ours, theirs = context.Pipe()
                process = context.Process(target=work, args=(theirs, *self._arguments), daemon=True)
                process.start()
                theirs.close()
                self.workers.append(Worker(process, ours))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Ends the processes."""
        for worker in self.workers:
            worker.process.terminate()
        for worker in self.workers:
            worker.process.join(_STOP_SECONDS)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
            worker.connection.close()

    def messages(self) -> Iterator[tuple[Worker, Message]]:
        """Yields messages as they come, while any worker has a block.

        Raises:
            UserError: a worker met a mistake of the user's.
            RuntimeError: a worker raised, or its process died.
        """
        while busy := {w.connection: w for w in self.workers if w.block is not None}:
            for ready in wait(list(busy)):
                worker = busy[ready]  # type: ignore[index]  # `wait` returns what it was given
                yield worker, _receive(worker)


def _receive(worker: Worker) -> Message:
    try:
        message: Message = worker.connection.recv()
    except (EOFError, ConnectionResetError) as error:
        worker.process.join(_STOP_SECONDS)
        raise RuntimeError(
            f"the process that ran {worker.block} died, exit status {worker.process.exitcode}"
        ) from error
    if isinstance(message, Failed):
        if message.by_user:
            raise UserError(message.text)
        raise RuntimeError(f"{worker.block} failed in its process:\n{message.text}")
    return message


@contextmanager
def _worker_environment() -> Iterator[None]:
    """What processes started inside inherit: one thread each, and SIGINT blocked.

    Blocked before they start, Ctrl-C cannot reach workers even while they import; the
    parent, which gets it as well, ends them. One thread, because sums in another order
    would round differently, and because the processes fill the cores already.
    """
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    before = {name: os.environ.get(name) for name in names}
    # Its first start unblocks SIGINT again, so it must not happen inside.
    resource_tracker.ensure_running()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
