"""Scenarios and runners for tests of the parallel runner; workers import them by name."""

import os
import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

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
        if not self._trace.exists():
            self._trace.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().run(episode)


class MistakenRunner(RaisingRunner):
    """Finds a mistake of the user's."""

    def run(self, episode: int) -> EpisodeResult:
        raise UserError(f"weights of {self._name}: none for episode {episode}")
