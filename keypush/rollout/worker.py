"""A worker process: runs the blocks that it is sent and writes each when it is done."""

import gc
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Protocol

from keypush.errors import UserError
from keypush.rollout.episode import EpisodeResult
from keypush.rollout.job import Block
from keypush.rollout.store import EpisodeStore
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
class BlockDone:
    """Message: a block has been written."""


@dataclass(frozen=True)
class Failed:
    """Message: the block raised."""

    text: str
    by_user: bool
    """Whether it was a `UserError`, whose text is meant for the user."""


Message = EpisodeDone | BlockDone | Failed


def work(connection: Connection, scenario: Scenario, folder: Path, make_runner: MakeRunner) -> None:
    """Serves blocks until the connection closes, which also happens when the parent dies."""
    store = EpisodeStore(folder)
    runner: Runner | None = None
    runs = ""
    try:
        while True:
            block: Block = connection.recv()
            if runner is None or block.object != runs:
                runner = None
                gc.collect()  # Python does not see how much memory a diagram holds.
                runner = make_runner(
                    replace(scenario, object=replace(scenario.object, name=block.object))
                )
                runs = block.object
            _run_block(connection, store, runner, block)
            connection.send(BlockDone())
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
    except UserError as error:
        connection.send(Failed(str(error), by_user=True))
    except Exception:
        connection.send(Failed(traceback.format_exc(), by_user=False))


def _run_block(connection: Connection, store: EpisodeStore, runner: Runner, block: Block) -> None:
    results = []
    for episode in range(block.first, block.first + block.count):
        results.append(runner.run(episode))
        connection.send(EpisodeDone(bool(results[-1].summary["success"])))
    store.write(block, [r.rows for r in results], [r.summary for r in results])
