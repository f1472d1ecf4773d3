"""Scenarios and runners for tests of the parallel runner; workers import them by name."""

import contextlib
import os
import signal
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pyarrow.parquet as pq

from keypush.errors import UserError
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.scenario import Scenario, parse_scenario


def short_scenario() -> Scenario:
    """An expert's episode of three policy steps."""
    return parse_scenario("{policy: expert, object: {name: plate}, episode: {max_steps: 3}}")


def bytes_of(folder: Path) -> dict[str, bytes]:
    """Contents of all files of a folder by their names."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def finished_episodes(folder: Path) -> int:
    """How many episodes a job's folder holds, in blocks and single ones.

    A stop between the writing of a block and the removal of its pieces leaves both: those episodes
    count once.
    """
    files = [*(folder / "episodes").glob("*.parquet")]
    files += (folder / "unfinished" / "episodes").glob("*.parquet")
    held = (pq.read_table(file, columns=["object", "episode"]).to_pylist() for file in files)
    return len({(row["object"], row["episode"]) for rows in held for row in rows})


class RaisingRunner:
    """Raises in episode 1."""

    def __init__(self, scenario: Scenario) -> None:
        self._name = scenario.object.name

    def run(self, episode: int) -> EpisodeResult:
        raise ZeroDivisionError(f"{self._name} {episode}")


class DyingRunner(RaisingRunner):
    """Its process is killed, as by a lack of memory."""

    def run(self, episode: int) -> EpisodeResult:
        os.kill(os.getpid(), signal.SIGKILL)
        return super().run(episode)


class DyingOnceRunner(EpisodeRunner):
    """Its process is killed in its first episode, unless a file says that one was."""

    def __init__(self, scenario: Scenario, *, trace: Path) -> None:
        super().__init__(scenario)
        self._trace = trace

    @classmethod
    def beside(cls, folder: Path) -> Callable[[Scenario], "DyingOnceRunner"]:
        """Makes runners whose file lies beside a folder."""
        return partial(cls, trace=folder.with_name(f"{folder.name}.died"))

    def run(self, episode: int) -> EpisodeResult:
        # Of several processes that come at once only the one that makes the file is killed.
        with contextlib.suppress(FileExistsError):
            self._trace.touch(exist_ok=False)
            os.kill(os.getpid(), signal.SIGKILL)
        return super().run(episode)


class DyingLaterRunner(DyingOnceRunner):
    """The same in episode 3."""

    def run(self, episode: int) -> EpisodeResult:
        return super().run(episode) if episode == 3 else EpisodeRunner.run(self, episode)


class InterruptingRunner(EpisodeRunner):
    """Interrupts its parent in episode 4, when the one before has been written."""

    def __init__(self, scenario: Scenario, *, folder: Path) -> None:
        super().__init__(scenario)
        self._episodes = folder / "unfinished" / "episodes"

    @classmethod
    def of(cls, folder: Path) -> Callable[[Scenario], "InterruptingRunner"]:
        """Makes runners of a job's folder."""
        return partial(cls, folder=folder)

    def run(self, episode: int) -> EpisodeResult:
        if episode == 4:
            while not list(self._episodes.glob("*-000003.parquet")):
                time.sleep(0.01)
            os.kill(os.getppid(), signal.SIGINT)
            time.sleep(60)
        return super().run(episode)


class MistakenRunner(RaisingRunner):
    """Finds a mistake of the user's."""

    def run(self, episode: int) -> EpisodeResult:
        raise UserError(f"weights of {self._name}: none for episode {episode}")
