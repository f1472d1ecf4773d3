"""What runs blocks, and the process that does so for a parent on the same machine."""

import gc
import traceback
from collections.abc import Callable
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

    success: bool


@dataclass(frozen=True)
class Failed:
    """Message: the block raised."""

    text: str
    by_user: bool
    """Whether it was a `UserError`, whose text is meant for the user."""


Message = EpisodeDone | Shard | Failed


class BlockWorker:
    """Runs blocks one after the other; keeps the diagram while the object stays the same."""

    def __init__(self, scenario: Scenario, make_runner: MakeRunner) -> None:
        """Args: what every episode shares, and what makes the runner of an object."""
        self._scenario = scenario
        self._make_runner = make_runner
        self._runner: Runner | None = None
        self._object = ""

    def run(self, block: Block, after_episode: Callable[[bool], None]) -> Shard | Failed:
        """Runs a block.

        Args:
            block: what to run.
            after_episode: called after each episode with its success; what it raises
                passes through.
        """
        results = []
        for episode in range(block.first, block.first + block.count):
            try:
                results.append(self._runner_of(block.object).run(episode))
            except UserError as error:
                return Failed(str(error), by_user=True)
            except Exception:
                return Failed(traceback.format_exc(), by_user=False)
            after_episode(bool(results[-1].summary["success"]))
        return make_shard(results)

    def _runner_of(self, name: str) -> Runner:
        if self._runner is None or name != self._object:
            self._runner = None
            gc.collect()  # Python does not see how much memory a diagram holds.
            scenario = replace(self._scenario, object=replace(self._scenario.object, name=name))
            self._runner, self._object = self._make_runner(scenario), name
        return self._runner


def work(connection: Connection, scenario: Scenario, make_runner: MakeRunner) -> None:
    """Serves blocks until the connection closes, which also happens when the parent dies.

    Nothing is written here, so that a process whose parent was killed leaves no trace.
    """
    worker = BlockWorker(scenario, make_runner)
    try:
        while True:
            block: Block = connection.recv()
            connection.send(worker.run(block, lambda ok: connection.send(EpisodeDone(ok))))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
