"""Kinematics of the arm alone, for controller and planners."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform
from pydrake.multibody.tree import JacobianWrtVariable

from keypush.control.differential_ik import JointLimits
from keypush.robot.panda import make_arm_plant
from keypush.scenario import RobotConfig

Array = NDArray[np.float64]


class ArmKinematics:
    """Pose and Jacobian of the tool, and the joints' limits.

    It owns a scratch context; every call sets the positions first, so that results depend
    on the arguments alone.
    """

    def __init__(self, config: RobotConfig) -> None:
        """Builds a plant of the arm alone."""
        self._plant, panda = make_arm_plant(config)
        self._tool = panda.tool_frame
        self._world = self._plant.world_frame()
        self._scratch = self._plant.CreateDefaultContext()
        self.limits = JointLimits(
            self._plant.GetPositionLowerLimits(),
            self._plant.GetPositionUpperLimits(),
            self._plant.GetVelocityUpperLimits(),
        )

    def tool_pose(self, q: Array) -> RigidTransform:
        """Returns X_WE for joint positions (7,) in rad."""
        self._plant.SetPositions(self._scratch, q)
        return self._tool.CalcPoseInWorld(self._scratch)

    def jacobian(self, q: Array) -> Array:
        """Returns the tool's Jacobian (6, 7) in W, translation (m/rad) first."""
        self._plant.SetPositions(self._scratch, q)
        J = self._plant.CalcJacobianSpatialVelocity(
            self._scratch,
            JacobianWrtVariable.kQDot,
            self._tool,
            np.zeros(3),
            self._world,
            self._world,
        )
        return np.vstack([J[3:], J[:3]])
