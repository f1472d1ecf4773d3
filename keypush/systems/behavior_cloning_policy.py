"""BehaviorCloningPolicy: a point cloud and a goal become tool actions, without stages."""

from typing import override

import numpy as np
from pydrake.systems.framework import BasicVector, Context, EventStatus, State

from keypush.eval_ports import eval_vector
from keypush.learning.model import ActionModel
from keypush.planning.plan_state import Stage
from keypush.scenario import ControlConfig
from keypush.systems.scene_system import SceneSystem, Vector

_ACTION = 6


class BehaviorCloningPolicy(SceneSystem):
    """Does what the network says, once per policy step (the thesis' baseline).

    @system
    name: BehaviorCloningPolicy
    input_ports:
    - point_cloud
    - goal
    - tool_pose
    - object_com (optional)
    - halted
    output_ports:
    - tool_action
    - stage
    - contact_target
    @endsystem

    ``point_cloud``: vector of 3 N, points p_WP in W in m, one after the other.

    ``goal``: vector of 2, goal xy in W in m.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m; its position and the first two
    columns of its rotation are the network's hand state (9).

    ``object_com``: vector of 3, p_WOcm in m; may stay unconnected if the model does not use
    the centre of mass.

    ``halted``: vector of 1; above 0.5 the action is zero: the tool stays where it is.

    ``tool_action``: vector of 6, residual of the tool pose in W: translation in m, then
    axis-angle in rad, within the clips of the control configuration; decided on the cloud of
    the policy step in which it is at work, and held for it. Zero before the first step.

    ``stage``: vector of 1, the `Stage` as a number: PUSH, or HALTED from the stop on; held.

    ``contact_target``: vector of 3, NaN: no contact is aimed at, and logs say so in this way.

    An action that is not finite is not passed on: the event raises `PolicyError`, which ends the
    simulation.
    """

    def __init__(
        self, model: ActionModel, points: int, control: ControlConfig, policy_period: float
    ) -> None:
        """Args: the model; number N of points of the cloud; clips of the action; period in s."""
        super().__init__(model, points, _ACTION + 1, policy_period)
        self.set_name("behavior_cloning_policy")
        self._clips = np.repeat([control.max_translation, control.max_rotation], 3)
        self._halted = self.DeclareVectorInputPort("halted", 1)
        self.DeclareVectorOutputPort(
            "tool_action", _ACTION, self._calc_action, prerequisites_of_calc=self._held
        )
        self.DeclareVectorOutputPort("stage", 1, self._calc_stage, prerequisites_of_calc=self._held)
        self.DeclareVectorOutputPort(
            "contact_target", 3, self._calc_target, prerequisites_of_calc={self.nothing_ticket()}
        )

    _answer_name = "action"

    @override
    def predict(self, context: Context) -> Vector:
        """Returns the action within its clips (6,), finite or not, and the stage."""
        action = super().predict(context)
        # Clipped, an infinite action would look like any other.
        within = np.where(np.isfinite(action), np.clip(action, -self._clips, self._clips), np.nan)
        return np.append(within, Stage.PUSH)

    @override
    def _first(self, answer: Vector) -> Vector:
        return np.append(np.zeros(_ACTION), Stage.PUSH)

    @override
    def _update(self, context: Context, state: State) -> EventStatus:
        if eval_vector(self._halted, context)[0] <= 0.5:
            return super()._update(context, state)
        held = np.append(np.zeros(_ACTION), Stage.HALTED)
        state.get_mutable_discrete_state(0).SetFromVector(held)
        return EventStatus.Succeeded()

    def _calc_action(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._answer(context)[:_ACTION])

    def _calc_stage(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._answer(context)[_ACTION:])

    def _calc_target(self, context: Context, output: BasicVector) -> None:  # noqa: ARG002 (Drake's)
        output.SetFromVector(np.full(3, np.nan))
