"""The arm of the default scenario, and joint positions for tests."""

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from keypush.control.arm_kinematics import ArmKinematics
from keypush.scenario import ControlConfig, RobotConfig

Array = NDArray[np.float64]

ARM = ArmKinematics(RobotConfig())
LIMITS = ARM.limits
CONTROL = ControlConfig()
CLIP = np.repeat([CONTROL.max_translation, CONTROL.max_rotation], 3)
READY = (np.array(RobotConfig().start_lower) + np.array(RobotConfig().start_upper)) / 2
"""The middle of the start box: bent elbow, tool down, far from every limit."""


def vectors(size: int, low: float, high: float) -> st.SearchStrategy[Array]:
    entry = st.floats(low, high)
    return st.lists(entry, min_size=size, max_size=size).map(np.array)


def positions(beyond: float = 0.0) -> st.SearchStrategy[Array]:
    """Joint positions within the limits, or up to `beyond` rad outside of them."""
    low, high = LIMITS.lower - beyond, LIMITS.upper + beyond
    return vectors(7, 0.0, 1.0).map(lambda unit: low + unit * (high - low))


starts = vectors(7, 0.0, 1.0).map(
    lambda unit: (
        np.array(RobotConfig().start_lower)
        + unit * (np.array(RobotConfig().start_upper) - np.array(RobotConfig().start_lower))
    )
)
"""Joint positions in the box of starts."""
actions = vectors(6, -1.0, 1.0).map(lambda unit: unit * CLIP)
