"""Inverse kinematics and the choice of the tool's posture."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.math import RigidTransform

from keypush.planning.posture import REACHED, Posture, choose_posture, solve_ik
from keypush.planning.push_frame import rotation_vector, tool_rotation
from keypush.scenario import PlannerConfig, RobotConfig
from tests.control.arm import ARM, LIMITS, READY, Array, vectors

ROBOT, PLANNER = RobotConfig(), PlannerConfig()
LOW, HIGH = np.array(ROBOT.start_lower), np.array(ROBOT.start_upper)
PITCH = float(np.deg2rad(PLANNER.pitch_deg))
YAW = float(np.deg2rad(PLANNER.wrist_yaw_deg))
HEIGHTS = [PLANNER.approach_height, PLANNER.approach_height / 2]
CANDIDATES = list(product([PITCH, PITCH + 0.1], HEIGHTS))


def test_poses_that_the_arm_has_are_found_from_elsewhere() -> None:
    rng = np.random.default_rng(0)
    found = 0
    for q, goal in rng.uniform(LOW, HIGH, size=(300, 2, 7)):
        X_WE = ARM.tool_pose(goal)
        q_found, error = solve_ik(ARM, q, X_WE)
        assert np.all((q_found > LIMITS.lower) & (q_found < LIMITS.upper))
        X_WF = ARM.tool_pose(q_found)
        offset = np.linalg.norm(X_WF.translation() - X_WE.translation())
        turn = np.linalg.norm(rotation_vector(X_WF.rotation(), X_WE.rotation()))
        if error < 0.005:
            found += 1
            assert offset < 0.005
            assert turn < 0.05
        else:
            assert max(offset, turn) > 0.001
    assert found >= 290


def test_a_pose_out_of_reach_keeps_its_error_and_the_limits() -> None:
    X_WE = RigidTransform(ARM.tool_pose(READY).rotation(), np.array([2.0, 0.0, 0.1]))
    found, error = solve_ik(ARM, READY, X_WE)
    missing = np.linalg.norm(ARM.tool_pose(found).translation() - X_WE.translation())
    assert error > 1.0
    assert missing > 1.0
    assert np.all((found > LIMITS.lower) & (found < LIMITS.upper))


@settings(max_examples=30)
@given(st.floats(-np.pi, np.pi), vectors(2, -0.1, 0.1))
def test_a_push_on_the_table_has_a_posture_that_the_arm_reaches(angle: float, xy: Array) -> None:
    d_W = np.array([np.cos(angle), np.sin(angle), 0.0])
    start = np.array([*xy, PLANNER.tool_height])
    waypoints = [start, start + 0.05 * d_W]
    posture, error = choose_posture(ARM, READY, d_W, waypoints, CANDIDATES, YAW)
    assert error < REACHED
    assert posture.side in (1, -1)
    assert posture.pitch in (PITCH, PITCH + 0.1)
    assert posture.height in HEIGHTS
    R_WE = tool_rotation(d_W, posture.pitch, posture.side)
    q = READY
    for p_WE in ([*xy, posture.height], *waypoints):
        q, error = solve_ik(ARM, q, RigidTransform(R_WE, np.array(p_WE)))
        assert error < 0.01


def test_the_preferred_posture_is_taken_where_it_can_be() -> None:
    d_W = np.array([1.0, 0.0, 0.0])
    start = np.array([0.0, 0.0, PLANNER.tool_height])
    waypoints = [start, start + 0.05 * d_W]
    posture, error = choose_posture(ARM, READY, d_W, waypoints, CANDIDATES, YAW)
    assert error < REACHED
    assert (posture.pitch, posture.height) == (PITCH, HEIGHTS[0])


@pytest.mark.parametrize(("wrist", "nearer"), [(-1.2, 1), (1.2, -1)])
def test_the_side_with_the_shorter_way_is_taken(wrist: float, nearer: int) -> None:
    d_W = np.array([1.0, 0.0, 0.0])
    start = np.array([0.0, 0.0, PLANNER.tool_height])
    above = np.array([0.0, 0.0, HEIGHTS[0]])
    q = READY.copy()
    q[6] += wrist
    ways = {}
    for side in (1, -1):
        there, error = solve_ik(ARM, q, RigidTransform(tool_rotation(d_W, PITCH, side), above))
        assert error < 0.005
        ways[side] = float(np.abs(there - q).max())
    posture, error = choose_posture(ARM, q, d_W, [start, start + 0.05 * d_W], CANDIDATES[:1], YAW)
    assert error < REACHED
    assert ways[nearer] < ways[-nearer]
    assert posture.side == nearer


def test_out_of_reach_the_least_bad_posture_is_taken() -> None:
    d_W = np.array([1.0, 0.0, 0.0])
    far = np.array([3.0, 0.0, PLANNER.tool_height])
    posture, error = choose_posture(ARM, READY, d_W, [far, far + d_W], CANDIDATES[:1], YAW)
    assert error > 1.0
    assert posture.side in (1, -1)
    assert posture.pitch == PITCH


LEFT = np.array([0.0, 1.0, 0.0])
"""A push which the arm reaches with either side."""
START = np.array([0.0, 0.0, PLANNER.tool_height])
PUSH = [START, START + 0.05 * LEFT]


@pytest.mark.parametrize("free", [1, -1])
def test_a_side_on_which_the_arm_gets_stuck_is_not_taken(free: int) -> None:
    def steps(posture: Posture) -> int | None:
        return 20 if posture.side == free else None

    posture, error = choose_posture(ARM, READY, LEFT, PUSH, CANDIDATES, YAW, steps=steps)
    assert error < REACHED
    assert posture == Posture(free, PITCH, HEIGHTS[0])
    only, error = choose_posture(
        ARM, READY, LEFT, PUSH, CANDIDATES[:2], YAW, sides=(-free,), steps=steps
    )
    assert error == REACHED
    assert only.side == -free


def test_where_the_arm_gets_stuck_in_all_it_is_the_preferred_one() -> None:
    posture, error = choose_posture(ARM, READY, LEFT, PUSH, CANDIDATES, YAW, steps=lambda _: None)
    assert error == REACHED
    assert posture == Posture(1, PITCH, HEIGHTS[0])
