"""The tool's pose and Jacobian; poses themselves have an oracle in tests/robot."""

import numpy as np
from hypothesis import given, settings

from keypush.control.arm_kinematics import ArmKinematics
from keypush.planning.push_frame import rotation_vector
from keypush.scenario import RobotConfig
from tests.control.arm import ARM, LIMITS, READY, Array, positions


@settings(max_examples=30)
@given(positions())
def test_jacobian_is_the_derivative_of_the_pose(q: Array) -> None:
    J, h = ARM.jacobian(q), 1e-6
    for i in range(7):
        step = h * np.eye(7)[i]
        X_WA, X_WB = ARM.tool_pose(q - step), ARM.tool_pose(q + step)
        shift = (X_WB.translation() - X_WA.translation()) / (2 * h)
        turn = rotation_vector(X_WA.rotation(), X_WB.rotation()) / (2 * h)
        np.testing.assert_allclose(J[:, i], [*shift, *turn], atol=1e-6)


def test_results_depend_on_the_arguments_alone() -> None:
    pose, J = ARM.tool_pose(READY).GetAsMatrix4(), ARM.jacobian(READY)
    ARM.jacobian(LIMITS.upper)
    np.testing.assert_array_equal(ARM.tool_pose(READY).GetAsMatrix4(), pose)
    ARM.tool_pose(LIMITS.lower)
    np.testing.assert_array_equal(ARM.jacobian(READY), J)


def test_the_base_carries_the_tool() -> None:
    moved = ArmKinematics(RobotConfig(base_position=[-0.3, 0.2, 0.1]))
    shift = moved.tool_pose(READY).translation() - ARM.tool_pose(READY).translation()
    np.testing.assert_allclose(shift, [0.2, 0.2, 0.1], atol=1e-12)


def test_limits_are_the_robots() -> None:
    np.testing.assert_array_equal(LIMITS.velocity, [2.175] * 4 + [2.61] * 3)
    assert np.all(LIMITS.lower < READY)
    assert np.all(LIMITS.upper > READY)
