"""Our description against another publication of the same robot."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from keypush.robot.panda import make_arm_plant
from keypush.scenario import RobotConfig
from tests.robot.panda_oracle import oracle_plant

LINKS = [*(f"panda_link{i}" for i in range(8)), "panda_hand", "panda_leftfinger"]
CONFIG = RobotConfig(base_position=[-0.4, 0.1, 0.05])
PLANT, PANDA = make_arm_plant(CONFIG)
ORACLE = oracle_plant(CONFIG.base_position)
FINGERS_CLOSED = np.zeros(2)
UNIT = st.lists(st.floats(0.0, 1.0), min_size=7, max_size=7)


@given(UNIT)
@settings(deadline=None)
def test_forward_kinematics_agree(unit: list[float]) -> None:
    lower, upper = PLANT.GetPositionLowerLimits(), PLANT.GetPositionUpperLimits()
    q = lower + np.array(unit) * (upper - lower)
    ours, theirs = PLANT.CreateDefaultContext(), ORACLE.CreateDefaultContext()
    PLANT.SetPositions(ours, q)
    ORACLE.SetPositions(theirs, np.concatenate([q, FINGERS_CLOSED]))
    pairs = [(PLANT.GetFrameByName(n), ORACLE.GetFrameByName(n)) for n in LINKS]
    pairs.append((PANDA.tool_frame, ORACLE.GetFrameByName("panda_hand_tcp")))
    for our_frame, their_frame in pairs:
        X_WA = our_frame.CalcPoseInWorld(ours).GetAsMatrix4()
        X_WB = their_frame.CalcPoseInWorld(theirs).GetAsMatrix4()
        np.testing.assert_allclose(X_WA, X_WB, atol=1e-6)


@pytest.mark.parametrize("name", [*LINKS, "panda_rightfinger"])
def test_inertia_is_the_published_one_and_possible(name: str) -> None:
    ours = PLANT.GetBodyByName(name).default_spatial_inertia()
    theirs = ORACLE.GetBodyByName(name).default_spatial_inertia()
    assert ours.get_mass() > 0
    assert ours.IsPhysicallyValid()
    np.testing.assert_allclose(ours.CopyToFullMatrix6(), theirs.CopyToFullMatrix6(), rtol=1e-9)


def test_limits_are_the_published_ones() -> None:
    upper = [2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]
    lower = [-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]
    np.testing.assert_array_equal(PLANT.GetPositionUpperLimits(), upper)
    np.testing.assert_array_equal(PLANT.GetPositionLowerLimits(), lower)
    np.testing.assert_array_equal(PLANT.GetVelocityUpperLimits(), [2.175] * 4 + [2.61] * 3)
    np.testing.assert_array_equal(PLANT.GetVelocityLowerLimits(), [-2.175] * 4 + [-2.61] * 3)


def test_start_box_lies_inside_the_limits() -> None:
    config = RobotConfig()
    assert np.all(PLANT.GetPositionLowerLimits() < config.start_lower)
    assert np.all(PLANT.GetPositionUpperLimits() > config.start_upper)
