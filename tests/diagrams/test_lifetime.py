"""A diagram goes when nobody uses it: workers build one per object, recordings hold a port."""

import gc
import weakref

import pytest
from pydrake.systems.framework import Diagram

from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import parse_scenario


def _dropped_diagram(policy: str) -> weakref.ref[Diagram]:
    scenario = parse_scenario(f"{{policy: {policy}, object: {{name: plate}}}}")
    runner = EpisodeRunner(scenario)
    runner.reset(0)
    return weakref.ref(runner.push.diagram)


@pytest.mark.parametrize("policy", ["expert", "centroid"])
def test_nothing_keeps_a_dropped_diagram_alive(policy: str) -> None:
    dropped = _dropped_diagram(policy)
    gc.collect()
    assert dropped() is None
