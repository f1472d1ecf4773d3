"""DifferentialIkController: a residual tool action becomes a joint position target."""

import numpy as np
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiscreteValues,
    EventStatus,
    LeafSystem,
)

from keypush.control.arm_kinematics import ArmKinematics
from keypush.control.joint_step import joint_step
from keypush.eval_ports import eval_vector
from keypush.robot.panda import NUM_JOINTS
from keypush.scenario import ControlConfig


class DifferentialIkController(LeafSystem):
    """Turns a residual tool action into a joint target, once per policy step.

    @system
    name: DifferentialIkController
    input_ports:
    - tool_action
    - arm_state
    output_ports:
    - arm_desired_state
    @endsystem

    ``tool_action``: vector of 6, residual of the tool pose in W: translation of Eo in m,
    then axis-angle in rad, applied before (to the left of) R_WE. Clipped per axis.

    ``arm_state``: vector of 14, measured joint positions (rad) and velocities (rad/s).

    ``arm_desired_state``: vector of 14, joint position targets (rad) and zero velocities,
    for the plant's `desired_state` port, whose implicit PD gains are the impedance. Held
    for one policy step.

    The joint step minimises |J dq - a|^2 + damping |dq|^2 within joint position and
    velocity limits (see `keypush.control.differential_ik`). At initialisation the target is
    the measured position.
    """

    def __init__(self, arm: ArmKinematics, config: ControlConfig, policy_period: float) -> None:
        """Args: kinematics of the arm, clips and damping, period in s."""
        super().__init__()
        self.set_name("differential_ik_controller")
        self._arm = arm
        self._config = config
        self._period = policy_period
        self._action = self.DeclareVectorInputPort("tool_action", 6)
        self._state = self.DeclareVectorInputPort("arm_state", 2 * NUM_JOINTS)
        target = self.DeclareDiscreteState(NUM_JOINTS)
        self.DeclareVectorOutputPort(
            "arm_desired_state",
            2 * NUM_JOINTS,
            self._calc_desired_state,
            prerequisites_of_calc={self.discrete_state_ticket(target)},
        )
        self.DeclareInitializationDiscreteUpdateEvent(self._hold)
        self.DeclarePeriodicDiscreteUpdateEvent(policy_period, 0.0, self._update)

    def _hold(self, context: Context, state: DiscreteValues) -> EventStatus:
        state.set_value(0, eval_vector(self._state, context)[:NUM_JOINTS])
        return EventStatus.Succeeded()

    def _update(self, context: Context, state: DiscreteValues) -> EventStatus:
        q = eval_vector(self._state, context)[:NUM_JOINTS]
        action = eval_vector(self._action, context)
        state.set_value(0, q + joint_step(self._arm, q, action, self._config, self._period))
        return EventStatus.Succeeded()

    def _calc_desired_state(self, context: Context, output: BasicVector) -> None:
        target = context.get_discrete_state(0).value()
        output.SetFromVector(np.concatenate([target, np.zeros_like(target)]))
