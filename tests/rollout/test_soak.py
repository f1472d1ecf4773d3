"""A long run in one process: no exception, flat memory."""

import gc
import resource
from pathlib import Path

import pytest

from keypush.objects.catalogue import catalogue_names
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import Scenario, parse_scenario
from tests.rollout.new_process import in_new_process

EPISODES = 500
RESIZED = 200


def _resident_megabytes() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 1e6


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_500_episodes_leave_memory_flat() -> None:
    """One diagram per object, as a worker has it: memory after the second round is the last's."""
    after_round, most = in_new_process(_soak)
    assert after_round[-1] < after_round[1] + 20
    assert most < 1000


def _soak() -> tuple[list[float], float]:
    """Returns the memory of this process after each round and the most that it had, MB."""
    names = catalogue_names()
    per_object = 9
    rounds = -(-EPISODES // (len(names) * per_object))
    after_round = []
    done = 0
    for number in range(rounds):
        for name in names:
            scenario = Scenario(policy="surface_no_com", seed=number)
            scenario.object.name = name
            gc.collect()  # as a worker does: Python does not see how much a diagram holds
            runner = EpisodeRunner(scenario)
            for episode in range(per_object):
                assert runner.run(episode).summary["outcome"] != "running"
                done += 1
        after_round.append(_resident_megabytes())
    assert done >= EPISODES
    return after_round, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_diagram_for_every_episode_leaves_memory_flat() -> None:
    """What varies has its largest cost in memory: a size that no other episode has."""
    scenario = parse_scenario("{policy: expert, object: {name: mug}, episode: {max_steps: 3}}")
    scenario.variation.size, scenario.variation.object_friction = [0.75, 1.25], [0.5, 1.5]
    runner = EpisodeRunner(scenario)
    resident = []
    for episode in range(RESIZED):
        runner.run(episode)
        resident.append(_resident_megabytes())
    assert resident[-1] < resident[RESIZED // 4] + 10
