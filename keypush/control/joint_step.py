"""What the controller makes of a residual tool action."""

import numpy as np
from numpy.typing import NDArray

from keypush.control.arm_kinematics import ArmKinematics
from keypush.control.differential_ik import solve_differential_ik
from keypush.scenario import ControlConfig

Array = NDArray[np.float64]


def joint_step(
    arm: ArmKinematics, q: Array, action: Array, config: ControlConfig, period: float
) -> Array:
    """Returns the joint step (7,) in rad for a residual tool action, within the joints' limits.

    Args:
        arm: kinematics and limits.
        q: (7,) joint positions, rad.
        action: (6,) translation in m, then axis-angle in rad, in W; clipped per axis.
        config: clips and damping.
        period: of a policy step, s.
    """
    clip = np.repeat([config.max_translation, config.max_rotation], 3)
    lower, upper = arm.limits.step_bounds(q, period)
    wanted = np.clip(action, -clip, clip)
    return solve_differential_ik(arm.jacobian(q), wanted, config.damping, lower, upper)
