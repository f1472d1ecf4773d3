"""The way to a push is rehearsed before it is taken, with an arm that follows the controller."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from keypush.control.joint_step import joint_step
from keypush.objects.library import make_object
from keypush.planning.plan_state import PlanState, PushObservation, Stage
from keypush.planning.posture import Posture, choose_posture
from keypush.planning.push_frame import push_direction
from keypush.planning.stages import PushStages
from keypush.rollout.start import StartSampler
from keypush.scenario import Scenario, TableConfig
from tests.control.arm import ARM, READY, Array
from tests.planning.ideal_tool import CONFIG, CONTROL, PERIOD, STAGES

SCENARIO = Scenario(policy="expert", seed=77)
HEIGHTS = [CONFIG.approach_height, CONFIG.approach_height / 2]
STARTS = [*range(12), 37, 54, 74, 86, 112, 126]
"""Among the last six an arm that only compares poses gets stuck on its way to some pushes."""


def stages_to_push(q: Array, p_WK: Array, goal: Array) -> list[Stage]:
    """Lets the arm's kinematics follow the planner until it pushes, or for 120 steps."""
    state, d_W = PlanState.start(ARM.tool_pose(q)), push_direction(p_WK, goal)
    distance = float(np.hypot(*(goal - p_WK[:2]))) - 0.05
    found = []
    for _ in range(120):
        seen = PushObservation(q, ARM.tool_pose(q), p_WK, d_W, distance)
        state = STAGES.advance(state, seen)
        found.append(state.stage)
        if state.stage == Stage.PUSH:
            break
        q = q + 0.7 * joint_step(ARM, q, STAGES.action(state, seen), CONTROL, PERIOD)
    return found


@pytest.mark.parametrize("episode", STARTS)
def test_the_arm_comes_to_its_push_without_getting_stuck(episode: int) -> None:
    model = make_object("block")
    start = StartSampler(SCENARIO, model).sample(episode)
    p_WO = start.X_WO.translation()
    rng = np.random.default_rng(episode)
    for _ in range(4):
        d_W = push_direction(p_WO, start.goal)
        off = rng.normal(0.0, 0.012, 2)
        p_WK = np.array([*(p_WO[:2] - 0.03 * d_W[:2] + off), 0.012])
        found = stages_to_push(start.q, p_WK, start.goal)
        assert found[-1] == Stage.PUSH
        entered = [a for a, b in zip(found, [None, *found], strict=False) if a != b]
        assert entered.count(Stage.APPROACH) == 1


def test_a_posture_that_gets_stuck_is_passed_over() -> None:
    d_W = np.array([1.0, 0.0, 0.0])
    start = np.array([0.0, 0.0, CONFIG.tool_height])
    waypoints, pitch = [start, start + 0.05 * d_W], float(np.deg2rad(CONFIG.pitch_deg))

    def chosen(**steps: int | None) -> Posture:
        return choose_posture(
            ARM,
            READY,
            d_W,
            waypoints,
            list(product([pitch, pitch + 0.1], HEIGHTS)),
            np.pi / 2,
            steps=lambda p: steps["left" if p.side == 1 else "right"] if p.pitch > pitch else None,
        )[0]

    assert chosen(left=30, right=40) == Posture(1, pitch + 0.1, HEIGHTS[0])
    assert chosen(left=50, right=40) == Posture(-1, pitch + 0.1, HEIGHTS[0])
    assert chosen(left=None, right=90) == Posture(-1, pitch + 0.1, HEIGHTS[0])
    # Nowhere does the arm get through: one that it reaches is still better than none.
    assert chosen(left=None, right=None).pitch in (pitch, pitch + 0.1)


def test_a_rehearsal_changes_nothing() -> None:
    state = replace(PlanState.start(ARM.tool_pose(READY)), steps=20)
    p_WK = np.array([0.02, 0.05, 0.012])
    seen = PushObservation(READY, ARM.tool_pose(READY), p_WK, np.array([1.0, 0.0, 0.0]), 0.1)
    again = PushStages(ARM, CONFIG, CONTROL, TableConfig(), PERIOD)
    first, second = STAGES.advance(state, seen), again.advance(state, seen)
    assert first.stage == Stage.APPROACH
    assert first.to_vector().tobytes() == second.to_vector().tobytes()
    assert STAGES.advance(state, seen).to_vector().tobytes() == first.to_vector().tobytes()
