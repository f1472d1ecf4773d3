"""Speed and truth of the simulation: CENIC, the discrete reference and MuJoCo side by side."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from keypush.bench.mujoco_runner import MujocoEpisodeRunner
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.scenario import Scenario

ENGINES = ("cenic", "discrete", "mujoco")
REFERENCE = "discrete"
REFERENCE_PERIOD = 1e-3
"""Time step of the reference, s."""


class _Runner(Protocol):
    def run(self, episode: int) -> EpisodeResult: ...


@dataclass
class Track:
    """What one engine did with one object's episodes, in order."""

    simulated: list[float] = field(default_factory=list)
    """Simulated time of every episode, s."""
    wall: list[float] = field(default_factory=list)
    """Wall time likewise, reset included and building excluded, s."""
    cpu: list[float] = field(default_factory=list)
    """Time of this process on a core likewise, s; other processes do not lengthen it."""
    outcomes: list[str] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)
    positions: list[NDArray[np.float64]] = field(default_factory=list)
    """Final p_WO (3,), m."""

    @property
    def rtf(self) -> float:
        """Simulated seconds per wall second."""
        return sum(self.simulated) / sum(self.wall)

    @property
    def rtf_cpu(self) -> float:
        """Simulated seconds per second on a core."""
        return sum(self.simulated) / sum(self.cpu)

    def measure(self, run: Callable[[int], EpisodeResult], episode: int) -> None:
        """Runs one episode and appends what it took and led to."""
        wall, cpu = time.perf_counter(), time.process_time()
        result = run(episode)
        self.cpu.append(time.process_time() - cpu)
        self.wall.append(time.perf_counter() - wall)
        self.simulated.append(result.seconds)
        summary = result.summary
        self.outcomes.append(str(summary["outcome"]))
        self.steps.append(int(str(summary["steps"])))
        self.positions.append(np.asarray(summary["final_position"], dtype=float))


def measure_objects(
    scenario: Scenario, objects: Sequence[str], episodes: int
) -> dict[str, dict[str, Track]]:
    """Runs the same episodes of every object with every engine, in this process.

    The engines take turns, episode by episode, so that whatever else the machine does
    slows all of them alike. A progress bar shows on a terminal.

    Args:
        scenario: all constants; the policy must be the expert.
        objects: catalogue names.
        episodes: number per object, from 0; episode 0 is also run once more to warm up.

    Returns:
        Tracks by object and engine.

    Raises:
        UserError: MuJoCo is not installed, or there is no such object.
    """
    tracks = {name: {engine: Track() for engine in ENGINES} for name in objects}
    with tqdm(total=len(objects) * episodes, unit="episode", disable=None) as bar:
        for name in objects:
            bar.set_postfix_str(name)
            runners = _make_runners(replace(scenario, object=replace(scenario.object, name=name)))
            for engine, runner in runners.items():
                # What a first run costs more is nothing beside an episode of the reference.
                if engine != REFERENCE:
                    runner.run(0)
            for episode in range(episodes):
                for engine, runner in runners.items():
                    tracks[name][engine].measure(runner.run, episode)
                bar.update()
    return tracks


def _make_runners(scenario: Scenario) -> dict[str, _Runner]:
    def drake(integrator: str) -> _Runner:
        simulation = replace(
            scenario.simulation, integrator=integrator, discrete_period=REFERENCE_PERIOD
        )
        return EpisodeRunner(replace(scenario, simulation=simulation))

    # MuJoCo first: if it is not installed, nothing else need be built.
    mujoco = MujocoEpisodeRunner(scenario)
    return {"cenic": drake("cenic"), "discrete": drake("discrete"), "mujoco": mujoco}
