"""What runs blocks, and the process that does so for a parent on the same machine."""

import gc
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import Protocol

from keypush.errors import UserError
from keypush.rollout.episode import EpisodeResult
from keypush.rollout.job import Block
from keypush.rollout.shard import Shard, make_shard
from keypush.scenario import Scenario


class Runner(Protocol):
    """Runs the episodes of one object."""

    def run(self, episode: int) -> EpisodeResult:
        """Runs one episode; the result depends on scenario and episode alone."""
        ...


MakeRunner = Callable[[Scenario], Runner]


@dataclass(frozen=True)
class EpisodeDone:
    """Message: an episode has ended."""

    episode: int
    shard: Shard


@dataclass(frozen=True)
class Failed:
    """Message: the block raised."""

    text: str
    by_user: bool
    """Whether it was a `UserError`, whose text is meant for the user."""


Message = EpisodeDone | Failed


class BlockWorker:
    """Runs blocks one after the other; keeps the diagram while job and object stay the same."""

    def __init__(self, scenarios: Sequence[Scenario], make_runner: MakeRunner) -> None:
        """Args: what the episodes of each job share, and what makes the runner of an object."""
        self._scenarios = scenarios
        self._make_runner = make_runner
        self._runner: Runner | None = None
        self._diagram: tuple[int, str] | None = None

    def run(self, block: Block, tell: Callable[[Message], None]) -> None:
        """Runs a block.

        Args:
            block: what to run.
            tell: is told of each episode that has ended, or of the failure of one, which is the
                last; what it raises passes through.
        """
        for episode in range(block.first, block.first + block.count):
            try:
                result = self._runner_of(block).run(episode)
            except UserError as error:
                return tell(Failed(str(error), by_user=True))
            except Exception:
                return tell(Failed(traceback.format_exc(), by_user=False))
            tell(EpisodeDone(episode, make_shard(result)))
        return None

    def _runner_of(self, block: Block) -> Runner:
        if self._runner is None or block.diagram != self._diagram:
            self._runner = None
            gc.collect()  # Python does not see how much memory a diagram holds.
            shared = self._scenarios[block.job]
            scenario = replace(shared, object=replace(shared.object, name=block.object))
            self._runner, self._diagram = self._make_runner(scenario), block.diagram
        return self._runner


def work(connection: Connection, scenarios: Sequence[Scenario], make_runner: MakeRunner) -> None:
    """Serves blocks until the connection closes, which also happens when the parent dies.

    Nothing is written here, so that a process whose parent was killed leaves no trace.
    """
    worker = BlockWorker(scenarios, make_runner)
    try:
        while True:
            block: Block = connection.recv()
            worker.run(block, connection.send)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
