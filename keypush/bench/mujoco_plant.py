"""MujocoPlant: MuJoCo's physics of the station as a Drake system."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.common.value import AbstractValue, Value
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DependencyTicket,
    DiscreteValues,
    EventStatus,
    LeafSystem,
)

from keypush.bench.development_package import import_development
from keypush.bench.mujoco_scene import OBJECT, TIME_STEP, TOOL
from keypush.eval_ports import eval_vector
from keypush.robot.panda import NUM_JOINTS
from keypush.rollout.start import EpisodeStart

Array = NDArray[np.float64]

_EARLY = 1e-6
"""MuJoCo's steps are done this much before the policy step that sees them, s."""
_OBJECT = slice(NUM_JOINTS, NUM_JOINTS + 7)
_TOUCHING = 1e-9


class MujocoPlant(LeafSystem):
    """Advances MuJoCo by one policy period at a time, its inputs held.

    @system
    name: MujocoPlant
    input_ports:
    - arm_desired_state
    - torque
    output_ports:
    - arm_state
    - tool_pose
    - object_pose
    - object_com
    - contact
    @endsystem

    ``arm_desired_state``: vector of 14, joint position targets (rad) and zero velocities.

    ``torque``: vector of 7, added to the actuators' PD torque in Nm, before the effort limit.

    ``arm_state``, ``tool_pose``, ``object_pose``, ``object_com``, ``contact``: as of the
    station's ports of these names.

    MuJoCo's whole state lives in the Context; `MjData` is scratch.
    """

    def __init__(self, model: Any, p_OoOcm_O: Array, stiffness: float, period: float) -> None:
        """Args: `MjModel`, the object's COM in O (3,), k_p in Nm/rad, policy period in s."""
        super().__init__()
        self.set_name("plant")
        self._mj = import_development("mujoco")
        self._model = model
        self._data = self._mj.MjData(model)
        self._p_OoOcm_O = p_OoOcm_O
        self._stiffness = stiffness
        self._steps = round(period / TIME_STEP)
        state = self._mj.mjtState
        self._parts = int(state.mjSTATE_PHYSICS) | int(state.mjSTATE_WARMSTART)
        self._size = self._mj.mj_stateSize(model, self._parts)
        self._object = model.body(OBJECT).id
        self._velocity = slice(model.nq, model.nq + NUM_JOINTS)
        self._target = self.DeclareVectorInputPort("arm_desired_state", 2 * NUM_JOINTS)
        self._torque = self.DeclareVectorInputPort("torque", NUM_JOINTS)
        # MuJoCo's state, then what was measured with it: tool position and rotation, contact.
        state_index = self.DeclareDiscreteState(self._size + 3 + 9 + 6)
        self._declare_outputs(self.discrete_state_ticket(state_index))
        self.DeclarePeriodicDiscreteUpdateEvent(period, period - _EARLY, self._advance)

    def _declare_outputs(self, state: DependencyTicket) -> None:
        held = {state}
        for name, size, calc in (
            ("arm_state", 2 * NUM_JOINTS, self._calc_arm_state),
            ("object_com", 3, self._calc_com),
            ("contact", 6, self._calc_contact),
        ):
            self.DeclareVectorOutputPort(name, size, calc, prerequisites_of_calc=held)
        for name, pose in (("tool_pose", self._calc_tool), ("object_pose", self._calc_object)):
            self.DeclareAbstractOutputPort(
                name,
                lambda: Value(RigidTransform()),
                pose,  # type: ignore[arg-type]  # pydrake types a calc's arguments as `object`
                prerequisites_of_calc=held,
            )

    def set_start(self, context: Context, start: EpisodeStart) -> None:
        """Puts arm and object, both at rest, at the start of an episode."""
        self._mj.mj_resetData(self._model, self._data)
        wxyz = start.X_WO.rotation().ToQuaternion().wxyz()
        self._data.qpos[:] = np.concatenate([start.q, start.X_WO.translation(), wxyz])
        context.SetDiscreteState(self._measured())

    def _advance(self, context: Context, state: DiscreteValues) -> EventStatus:
        data = self._data
        values = context.get_discrete_state(0).value()
        self._mj.mj_setState(self._model, data, values[: self._size], self._parts)
        target = eval_vector(self._target, context)[:NUM_JOINTS]
        # Through the actuator, so that the effort limit holds for the sum, as in Drake.
        data.ctrl[:] = target + eval_vector(self._torque, context) / self._stiffness
        self._mj.mj_step(self._model, data, self._steps)
        state.set_value(0, self._measured())
        return EventStatus.Succeeded()

    def _measured(self) -> Array:
        """MuJoCo's state with the tool pose and the contact of its last step."""
        data = self._data
        state = np.empty(self._size)
        self._mj.mj_getState(self._model, data, state, self._parts)
        contact = self._measure_contact()
        self._mj.mj_kinematics(self._model, data)
        tool = data.site(TOOL)
        return np.concatenate([state, tool.xpos, tool.xmat, contact])

    def _measure_contact(self) -> Array:
        data = self._data
        bodies = self._model.geom_bodyid[data.contact.geom]
        total, point, weight = np.zeros(3), np.zeros(3), 0.0
        wrench = np.empty(6)
        for i in np.flatnonzero((bodies == self._object).any(axis=1) & (bodies > 0).all(axis=1)):
            self._mj.mj_contactForce(self._model, data, i, wrench)
            # In the contact's axes, on the second body.
            force = data.contact.frame[i].reshape(3, 3).T @ wrench[:3]
            total += force if bodies[i, 1] == self._object else -force
            size = float(np.linalg.norm(force))
            point, weight = point + size * data.contact.pos[i], weight + size
        if weight < _TOUCHING:
            return np.concatenate([np.full(3, np.nan), np.zeros(3)])
        return np.concatenate([point / weight, total])

    def _values(self, context: Context) -> Array:
        return np.asarray(context.get_discrete_state(0).value())

    def _calc_arm_state(self, context: Context, output: BasicVector) -> None:
        values = self._values(context)
        output.SetFromVector(np.concatenate([values[:NUM_JOINTS], values[self._velocity]]))

    def _object_pose(self, context: Context) -> RigidTransform:
        pose = self._values(context)[_OBJECT]
        return RigidTransform(Quaternion(pose[3:] / np.linalg.norm(pose[3:])), pose[:3])

    def _calc_object(self, context: Context, output: AbstractValue) -> None:
        output.set_value(self._object_pose(context))

    def _calc_com(self, context: Context, output: BasicVector) -> None:
        X_WO = self._object_pose(context)
        output.SetFromVector(X_WO.rotation().matrix() @ self._p_OoOcm_O + X_WO.translation())

    def _calc_tool(self, context: Context, output: AbstractValue) -> None:
        tool = self._values(context)[self._size : self._size + 12]
        R_WE = RotationMatrix.ProjectToRotationMatrix(tool[3:].reshape(3, 3))
        output.set_value(RigidTransform(R_WE, tool[:3]))

    def _calc_contact(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._values(context)[-6:])
