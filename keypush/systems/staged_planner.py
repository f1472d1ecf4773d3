"""What the two planners share: stages, state, tool input, outputs."""

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from keypush.control.arm_kinematics import ArmKinematics
from keypush.eval_ports import eval_abstract, eval_vector
from keypush.planning.plan_state import PlanState, PushObservation, Stage
from keypush.planning.stages import PushStages
from keypush.robot.panda import NUM_JOINTS
from keypush.scenario import ControlConfig, PlannerConfig, TableConfig

SHORT_OF_GOAL = 0.05
"""A push is planned to end this far before the goal, m: where it succeeds by default."""
_PLAN = slice(0, PlanState.SIZE)
_ACTION = slice(PlanState.SIZE, PlanState.SIZE + 6)
_TARGET = slice(_ACTION.stop, _ACTION.stop + 3)
_DIRECTION = slice(_TARGET.stop, _TARGET.stop + 3)
_UP = slice(_DIRECTION.stop, _DIRECTION.stop + 3)


class StagedPlanner(LeafSystem):
    """Base of the planners: runs `PushStages` once per policy step.

    It updates in unrestricted events, which Drake handles before discrete ones: so the
    controller, whose event is discrete, acts in the same policy step on the new action.
    """

    def __init__(
        self,
        arm: ArmKinematics,
        config: PlannerConfig,
        control: ControlConfig,
        table: TableConfig,
        policy_period: float,
    ) -> None:
        """Args: arm's kinematics, stage constants, clips of the action, table, period in s."""
        super().__init__()
        self._config = config
        self._stages = PushStages(arm, config, control, table, policy_period)
        self._held = {self.discrete_state_ticket(self.DeclareDiscreteState(_UP.stop))}
        self.DeclareInitializationUnrestrictedUpdateEvent(self._start)
        self.DeclarePeriodicUnrestrictedUpdateEvent(policy_period, 0.0, self._update)

    def _declare_shared_ports(self) -> None:
        """Declares the ports that come after the planner's own inputs."""
        self._tool_pose = self.DeclareAbstractInputPort("tool_pose", Value(RigidTransform()))
        self._arm_state = self.DeclareVectorInputPort("arm_state", 2 * NUM_JOINTS)
        self._halted = self.DeclareVectorInputPort("halted", 1)
        self.DeclareVectorOutputPort(
            "tool_action", 6, self._calc_action, prerequisites_of_calc=self._held
        )
        self.DeclareVectorOutputPort("stage", 1, self._calc_stage, prerequisites_of_calc=self._held)
        self.DeclareVectorOutputPort(
            "contact_target", 3, self._calc_target, prerequisites_of_calc=self._held
        )

    @abstractmethod
    def _aim(self, context: Context) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Returns the contact p_WK (3,), the direction d_W (3,) and how far to push, m."""

    @abstractmethod
    def _up(self, context: Context) -> NDArray[np.float64]:
        """Returns a direction (3,) that turns as far as the object tilts."""

    def _reset_offset(  # a hook: only the expert looks at its arguments
        self,
        context: Context,  # noqa: ARG002
        state: PlanState,  # noqa: ARG002
    ) -> NDArray[np.float64] | None:
        """Returns where to retreat to (2,), along d and to its left of K, if now."""
        return None

    def _tool(self, context: Context) -> RigidTransform:
        X_WE: RigidTransform = eval_abstract(self._tool_pose, context)
        return X_WE

    def _start(self, context: Context, state: State) -> EventStatus:
        values = np.zeros(_UP.stop)
        values[_PLAN] = PlanState.start(self._tool(context)).to_vector()
        values[_UP] = self._up(context)
        state.get_mutable_discrete_state(0).SetFromVector(values)
        return EventStatus.Succeeded()

    def _update(self, context: Context, state: State) -> EventStatus:
        held = context.get_discrete_state(0).value()
        plan = PlanState.from_vector(held[_PLAN])
        p_WK, d_W, distance = self._aim(context)
        if plan.stage == Stage.PUSH and not self._config.reaim:
            p_WK, d_W = held[_TARGET].copy(), held[_DIRECTION].copy()
        seen = PushObservation(
            q=eval_vector(self._arm_state, context)[:NUM_JOINTS],
            X_WE=self._tool(context),
            p_WK=p_WK,
            d_W=d_W,
            distance=distance,
            halted=bool(eval_vector(self._halted, context)[0] > 0.5),
            reset_offset=self._reset_offset(context, plan),
            tilt=float(np.arccos(np.clip(held[_UP] @ self._up(context), -1.0, 1.0))),
        )
        plan = self._stages.advance(plan, seen)
        action = self._stages.action(plan, seen)
        state.get_mutable_discrete_state(0).SetFromVector(
            np.concatenate([plan.to_vector(), action, p_WK, d_W, held[_UP]])
        )
        return EventStatus.Succeeded()

    def _calc_action(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(0).value()[_ACTION])

    def _calc_stage(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(0).value()[:1])

    def _calc_target(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(0).value()[_TARGET])
