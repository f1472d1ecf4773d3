"""ExpertPlanner: the analytic expert, which knows the object's geometry and COM."""

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from keypush.control.arm_kinematics import ArmKinematics
from keypush.eval_ports import eval_abstract, eval_vector
from keypush.planning.contact import push_through_com
from keypush.planning.plan_state import PlanState, Stage
from keypush.scenario import ControlConfig, PlannerConfig, TableConfig
from keypush.systems.episode_seed import declare_episode_seed, episode_generator, policy_step
from keypush.systems.staged_planner import SHORT_OF_GOAL, StagedPlanner


class ExpertPlanner(StagedPlanner):
    """Pushes through the true centre of mass: k = c - r d (thesis, section 4.3, sign mended).

    @system
    name: ExpertPlanner
    input_ports:
    - object_pose
    - object_com
    - goal
    - tool_pose
    - arm_state
    - halted
    output_ports:
    - tool_action
    - stage
    - contact_target
    @endsystem

    ``object_pose``: abstract `RigidTransform`, X_WO in m; ground truth.

    ``object_com``: vector of 3, p_WOcm in m; ground truth.

    ``goal``: vector of 2, goal xy in W in m.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m.

    ``arm_state``: vector of 14, measured joint positions (rad) and velocities (rad/s).

    ``halted``: vector of 1; above 0.5 the tool stops at its reference.

    ``tool_action``: vector of 6, residual of the tool pose in W: translation in m, then
    axis-angle in rad; held for one policy step.

    ``stage``: vector of 1, the `Stage` as a number; held likewise.

    ``contact_target``: vector of 3, the analytic contact p_WK in m; held.

    With `reset_period` > 0 the tool lets go every so many policy steps of pushing and comes
    again (the thesis' reset heuristic); its noise depends on seed, episode and policy step
    alone (parameter [seed, episode]).
    """

    def __init__(
        self,
        p_OP: NDArray[np.float64],
        arm: ArmKinematics,
        config: PlannerConfig,
        control: ControlConfig,
        table: TableConfig,
        policy_period: float,
    ) -> None:
        """Args: surface points (N, 3) in O in m; the rest as for `PushStages`."""
        super().__init__(arm, config, control, table, policy_period)
        self.set_name("expert_planner")
        self._p_OP_O = np.asarray(p_OP, dtype=float)
        self._period = policy_period
        declare_episode_seed(self)
        self._object_pose = self.DeclareAbstractInputPort("object_pose", Value(RigidTransform()))
        self._object_com = self.DeclareVectorInputPort("object_com", 3)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._declare_shared_ports()

    def _aim(self, context: Context) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        X_WO: RigidTransform = eval_abstract(self._object_pose, context)
        p_WOcm = eval_vector(self._object_com, context)
        goal = eval_vector(self._goal, context)
        p_WK, d_W, distance = push_through_com(self._p_OP_O, X_WO, p_WOcm, goal)
        return p_WK, d_W, distance - SHORT_OF_GOAL

    def _up(self, context: Context) -> NDArray[np.float64]:
        X_WO: RigidTransform = eval_abstract(self._object_pose, context)
        return np.asarray(X_WO.rotation().matrix()[2])

    def _reset_offset(self, context: Context, state: PlanState) -> NDArray[np.float64] | None:
        period = self._config.reset_period
        if period == 0 or state.stage != Stage.PUSH or state.steps < period:
            return None
        half = self._config.reset_deviation
        generator = episode_generator(context, "reset", policy_step(context, self._period))
        noise = generator.uniform(-half, half, size=2)
        return np.array([-self._config.reset_retreat, 0.0]) + noise
