"""Policies and conditions face the same episodes: start, goal, arm and noise."""

from dataclasses import replace

import numpy as np
import pytest

from keypush.objects.library import make_object
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.start import EpisodeStart, StartSampler
from keypush.scenario import Scenario
from keypush.seeding import EVALUATION_SEEDS

SIZES = (0.75, 0.875, 1.0, 1.125, 1.25)
PLAIN = Scenario(seed=EVALUATION_SEEDS)


def _scenario(policy: str, com_shift: float = 0.0) -> Scenario:
    return replace(
        PLAIN,
        policy=policy,
        object=replace(PLAIN.object, name="can"),
        variation=replace(PLAIN.variation, com_shift=com_shift),
    )


def _first_sight(scenario: Scenario, episode: int) -> tuple[bytes, ...]:
    """Start, and the first noisy cloud."""
    runner = EpisodeRunner(scenario)
    start = runner.reset(episode)
    station = runner.push.station
    root = runner._simulator.get_context()
    cloud = station.diagram.GetOutputPort("point_cloud").Eval(
        station.diagram.GetMyContextFromRoot(root)
    )
    return (*_bytes(start), np.asarray(cloud).tobytes())


def _bytes(start: EpisodeStart) -> tuple[bytes, bytes, bytes]:
    place = start.X_WO.GetAsMatrix34()[:2].tobytes()
    return place, start.goal.tobytes(), start.q.tobytes()


@pytest.mark.parametrize("episode", [0, 1])
def test_every_policy_and_shift_has_the_same_episodes(episode: int) -> None:
    expert = _first_sight(_scenario("expert"), episode)
    assert _first_sight(_scenario("geometric"), episode) == expert
    assert _first_sight(_scenario("surface_no_com"), episode) == expert
    assert _first_sight(_scenario("geometric", com_shift=0.015), episode) == expert
    assert _first_sight(_scenario("geometric"), episode + 1) != expert


def _starts(name: str, size_ratio: float, episodes: int) -> list[tuple[bytes, bytes, bytes]]:
    scenario = replace(PLAIN, object=replace(PLAIN.object, name=name, size_ratio=size_ratio))
    sampler = StartSampler(scenario, make_object(name, size_ratio))
    return [_bytes(sampler.sample(episode)) for episode in range(episodes)]


def test_most_episodes_are_the_same_in_every_size() -> None:
    """A start is drawn again where an object of that size does not fit or cannot be reached."""
    names, episodes = ("mug", "plate", "candle"), 20
    same = 0
    for name in names:
        by_size = zip(*(_starts(name, size, episodes) for size in SIZES), strict=True)
        same += sum(len({(place, goal) for place, goal, _ in starts}) == 1 for starts in by_size)
    assert same >= 0.8 * len(names) * episodes
