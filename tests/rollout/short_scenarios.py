"""Scenarios and runners for tests of the parallel runner; workers import them by name."""

import os
import signal

from keypush.errors import UserError
from keypush.rollout.episode import EpisodeResult
from keypush.scenario import Scenario, parse_scenario


def short_scenario() -> Scenario:
    """An expert's episode of three policy steps."""
    return parse_scenario("{policy: expert, object: {name: plate}, episode: {max_steps: 3}}")


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


class MistakenRunner(RaisingRunner):
    """Finds a mistake of the user's."""

    def run(self, episode: int) -> EpisodeResult:
        raise UserError(f"weights of {self._name}: none for episode {episode}")
