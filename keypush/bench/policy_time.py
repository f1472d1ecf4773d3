"""What an episode of every policy costs, and how much of it is physics, network and Python."""

import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import FrameType
from typing import Any

from rich.table import Table

from keypush import eval_ports
from keypush.bench.stack_samples import sampled
from keypush.policies import POLICIES
from keypush.rollout import episode as rollout_episode
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import Scenario

PARTS = ("physics", "network", "reset", "python")
"""Drake's C++, also where a system asks for it; patches and network; drawing a start; systems."""
_NETWORK = ("keypush.learning.inference", "keypush.learning.predict")


def measure_policies(
    scenario: Scenario, objects: Sequence[str], episodes: int
) -> list[dict[str, Any]]:
    """Runs episodes of every policy in this process, the same ones.

    The policies take turns from object to object, so that whatever else the machine does slows all
    alike.

    Args:
        scenario: of all; its policy is replaced.
        objects: names.
        episodes: number per object.

    Raises:
        UserError: weights do not ship.
    """
    found = {policy: _Cost() for policy in POLICIES}
    for name in objects:
        shown = replace(scenario, object=replace(scenario.object, name=name))
        for policy, cost in found.items():
            cost.add(EpisodeRunner(replace(shown, policy=policy)), episodes)
    return [{"policy": policy, **cost.describe()} for policy, cost in found.items()]


def policies_table(report: dict[str, Any]) -> Table:
    """Lays the report out."""
    table = Table("policy", "CPU s an episode", "steps", *PARTS, title=report["title"])
    for line in report["policies"]:
        table.add_row(
            line["policy"],
            f"{line['cpu_seconds_per_episode']:.2f}",
            f"{line['steps_per_episode']:.0f}",
            *(f"{line['shares'][part]:.0%}" for part in PARTS),
        )
    return table


def summarise_policies(policies: list[dict[str, Any]], episodes: int) -> dict[str, Any]:
    """Returns the report.

    Args:
        policies: of `measure_policies`.
        episodes: of each.
    """
    return {"title": f"{episodes} episodes of each policy", "policies": policies}


class _Cost:
    """Sums of one policy."""

    def __init__(self) -> None:
        self._episodes = self._steps = 0
        self._seconds = 0.0
        self._samples: Counter[str] = Counter()

    def add(self, runner: EpisodeRunner, episodes: int) -> None:
        """Runs episodes."""
        began = time.process_time()
        with sampled(_part) as samples:
            for number in range(episodes):
                self._steps += len(runner.run(number).rows["stage"])
        self._seconds += time.process_time() - began
        self._samples += samples
        self._episodes += episodes

    def describe(self) -> dict[str, Any]:
        total = self._samples.total()
        return {
            "episodes": self._episodes,
            "cpu_seconds_per_episode": self._seconds / self._episodes,
            "steps_per_episode": self._steps / self._episodes,
            "shares": {part: self._samples[part] / total for part in PARTS},
        }


def _part(innermost: FrameType) -> str:
    if innermost.f_globals["__name__"] in (rollout_episode.__name__, eval_ports.__name__):
        return "physics"  # The thread is in a call of Drake's that has no frame of its own.
    modules = [frame.f_globals["__name__"] for frame in _stack(innermost)]
    if any(module.startswith(_NETWORK) for module in modules):
        return "network"
    if any(frame.f_code.co_name == "reset" for frame in _stack(innermost)):
        return "reset"
    return "python"


def _stack(frame: FrameType | None) -> Iterator[FrameType]:
    while frame is not None:
        yield frame
        frame = frame.f_back
