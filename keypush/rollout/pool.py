"""Long-lived worker processes that Ctrl-C, a crash or the end of the parent cannot orphan."""

import multiprocessing
import signal
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Self

from keypush.rollout.engine import Event, Lost, raise_failure
from keypush.rollout.job import Block, take_block
from keypush.rollout.worker import Failed, MakeRunner, Message, work
from keypush.scenario import Scenario
from keypush.worker_environment import usable_cores, worker_environment

_STOP_SECONDS = 5.0


@dataclass
class _Worker:
    """A process and what it does."""

    process: SpawnProcess
    connection: Connection
    block: Block | None = None
    """What is left of the block under way."""
    last: Block | None = None
    """The block whose diagram it holds."""

    def start(self, block: Block) -> None:
        """Hands it a block; if it is dead, that shows when its message is awaited."""
        self.block = self.last = block
        with suppress(BrokenPipeError, ConnectionResetError):
            self.connection.send(block)

    def receive(self) -> Message | Lost:
        """Waits for a message, which may be that its process is dead."""
        try:
            message: Message = self.connection.recv()
        except (EOFError, OSError):  # OSError: it died in the midst of a message.
            self.process.join(_STOP_SECONDS)
            return Lost(_how_it_ended(self.process.exitcode))
        return message

    def end(self) -> None:
        """Ends the process, gently first."""
        self.process.terminate()
        self.process.join(_STOP_SECONDS)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        self.connection.close()


class LocalEngine:
    """Starts worker processes on entry and ends them, at once, on exit."""

    def __init__(
        self, workers: int | None, scenarios: Sequence[Scenario], make_runner: MakeRunner
    ) -> None:
        """Args: see `make_engine`."""
        self.workers = usable_cores() if workers is None else workers
        self._arguments = (tuple(scenarios), make_runner)
        self._workers: list[_Worker] = []

    def __enter__(self) -> Self:
        """Processes start when there is a block for each."""
        return self

    def __exit__(self, *error: object) -> None:
        """Ends the processes."""
        for worker in self._workers:
            worker.process.terminate()
        for worker in self._workers:
            worker.end()

    def run(self, pending: list[Block]) -> Iterator[tuple[Block, Event]]:
        """Runs blocks, see `Engine`."""
        for _ in range(min(self.workers, len(pending))):
            self._start_worker(pending)
        while busy := {w.connection: w for w in self._workers if w.block is not None}:
            for ready in wait(list(busy)):
                yield from self._next_event(busy[ready], pending)  # type: ignore[index]  # `wait` returns what it was given

    def _next_event(self, worker: _Worker, pending: list[Block]) -> Iterator[tuple[Block, Event]]:
        block = worker.block
        assert block is not None
        message = worker.receive()
        if isinstance(message, Failed):
            raise_failure(message, block)
        elif isinstance(message, Lost):
            pending.append(block)
            yield block, message
            self._workers.remove(worker)
            worker.end()
            self._start_worker(pending)
        else:
            worker.block = block.after(message.episode)
            if worker.block is None and pending:
                # Before the yield: it need not wait until its files are written.
                worker.start(take_block(pending, worker.last))
            yield block.one(message.episode), message

    def _start_worker(self, pending: list[Block]) -> None:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        with worker_environment():
            process = context.Process(target=work, args=(theirs, *self._arguments), daemon=True)
            process.start()
        theirs.close()
        worker = _Worker(process, ours)
        self._workers.append(worker)
        worker.start(take_block(pending, None))


def _how_it_ended(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        name = signal.Signals(-exit_code).name
        hint = ", often for lack of memory" if name == "SIGKILL" else ""
        return f"was ended by {name}{hint}"
    return f"ended with status {exit_code}"
