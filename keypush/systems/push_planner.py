"""PushPlanner: a keypoint and a goal become residual tool actions."""

from typing import override

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import Context

from keypush.control.arm_kinematics import ArmKinematics
from keypush.eval_ports import eval_vector
from keypush.planning.push_frame import push_direction
from keypush.scenario import ControlConfig, PlannerConfig, TableConfig
from keypush.systems.staged_planner import SHORT_OF_GOAL, StagedPlanner

_UPRIGHT = np.array([0.0, 0.0, 1.0])


class PushPlanner(StagedPlanner):
    """Pushes at a keypoint towards the goal: d = (g - k)/|g - k| (thesis, equation 4.2).

    @system
    name: PushPlanner
    input_ports:
    - keypoint
    - goal
    - object_up (optional)
    - tool_pose
    - arm_state
    - halted
    output_ports:
    - tool_action
    - stage
    - contact_target
    @endsystem

    ``keypoint``: vector of 3, p_WK in m: where to touch the object.

    ``goal``: vector of 2, goal xy in W in m.

    ``object_up``: vector of 3, where what was vertical in the object at rest points now, in W;
    unconnected, the object is taken for upright, and a push does not give way to its tilt.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m.

    ``arm_state``: vector of 14, measured joint positions (rad) and velocities (rad/s).

    ``halted``: vector of 1; above 0.5 the tool stops at its reference.

    ``tool_action``: vector of 6, residual of the tool pose in W: translation in m, then
    axis-angle in rad; held for one policy step.

    ``stage``: vector of 1, the `Stage` as a number; held likewise.

    ``contact_target``: vector of 3, the contact in W in m that the action aims at; held.
    """

    def __init__(
        self,
        arm: ArmKinematics,
        config: PlannerConfig,
        control: ControlConfig,
        table: TableConfig,
        policy_period: float,
    ) -> None:
        """Args: as for `PushStages`."""
        super().__init__(arm, config, control, table, policy_period)
        self.set_name("push_planner")
        self._keypoint = self.DeclareVectorInputPort("keypoint", 3)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._object_up = self.DeclareVectorInputPort("object_up", 3)
        self._declare_shared_ports()

    @override
    def _up(self, context: Context) -> NDArray[np.float64]:
        if not self._object_up.HasValue(context):
            return _UPRIGHT
        return eval_vector(self._object_up, context)

    def _aim(self, context: Context) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        p_WK, goal = eval_vector(self._keypoint, context), eval_vector(self._goal, context)
        distance = float(np.hypot(*(goal - p_WK[:2]))) - SHORT_OF_GOAL
        return p_WK, push_direction(p_WK, goal), distance
