"""Long-lived worker processes that Ctrl-C, a crash or the end of the parent cannot orphan."""

import multiprocessing
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from types import TracebackType
from typing import Self

from keypush.errors import UserError
from keypush.rollout.job import Block
from keypush.rollout.worker import Failed, MakeRunner, Message, work
from keypush.scenario import Scenario
from keypush.worker_environment import worker_environment

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
        with worker_environment():
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
