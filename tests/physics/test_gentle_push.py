"""A push touches gently and slides on the table, so that objects with a small base stay upright."""

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from keypush.planning.plan_state import Stage
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import ObjectConfig, Scenario

PERIOD = 0.1


@cache
def push(name: str) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The tool tip in W (N, 3), and in which of the N rows it pushes and touches."""
    scenario = Scenario(policy="expert", object=ObjectConfig(name=name))
    rows = EpisodeRunner(scenario).run(episode=0).rows
    touching = np.isfinite(rows["contact_point"]).all(axis=1)
    return np.asarray(rows["tool_pose"])[:, 4:], touching & (rows["stage"] == Stage.PUSH)


@pytest.mark.parametrize("name", ["candle", "bottle", "block"])
def test_a_pushing_tool_slides_on_the_table_without_hopping(name: str) -> None:
    p_WE, pushing = push(name)
    z = p_WE[:, 2]
    throughout = pushing[:-2] & pushing[1:-1] & pushing[2:]
    hops = np.abs(z[1:-1] - (z[:-2] + z[2:]) / 2)[throughout]
    assert len(hops) > 10
    assert np.median(hops) < 5e-5


@pytest.mark.parametrize("name", ["candle", "block"])
def test_the_tool_is_slow_when_it_first_touches(name: str) -> None:
    """As long as that is not right at the start of the slow stretch."""
    p_WE, pushing = push(name)
    first = int(np.argmax(pushing))
    moved = p_WE[first] - p_WE[first - 1]
    assert np.hypot(*moved[:2]) / PERIOD < 0.04
