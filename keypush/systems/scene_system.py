"""What the systems share that ask a model about the scene: inputs, and what is not finite."""

import logging
from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from keypush.eval_ports import eval_abstract, eval_vector
from keypush.learning.hand import hand_state
from keypush.learning.model import PolicyModel

_log = logging.getLogger(__name__)

Vector = NDArray[np.float64]


class SceneSystem(LeafSystem):
    """Base of the systems that hold a model's answer for one policy step.

    The state is the held answer and the count of answers that were not finite. It updates in
    unrestricted events, which Drake handles before discrete ones (see `StagedPlanner`).
    """

    def __init__(self, model: PolicyModel, points: int, size: int, policy_period: float) -> None:
        """Args: the model; points of the cloud; numbers of an answer; period in s."""
        super().__init__()
        self._model = model
        self._size = size
        self._cloud = self.DeclareVectorInputPort("point_cloud", 3 * points)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._tool_pose = self.DeclareAbstractInputPort("tool_pose", Value(RigidTransform()))
        self._com = self.DeclareVectorInputPort("object_com", 3)
        self._held = {self.discrete_state_ticket(self.DeclareDiscreteState(size + 1))}
        self.DeclareInitializationUnrestrictedUpdateEvent(self._start)
        self.DeclarePeriodicUnrestrictedUpdateEvent(policy_period, 0.0, self._update)

    def predict(self, context: Context) -> Vector:
        """Returns the model's answer to the inputs, finite or not."""
        X_WE: RigidTransform = eval_abstract(self._tool_pose, context)
        hand = hand_state(X_WE.GetAsMatrix34())
        com = eval_vector(self._com, context) if self._com.HasValue(context) else None
        cloud = eval_vector(self._cloud, context).reshape(-1, 3)
        return self._model.predict(cloud, eval_vector(self._goal, context), com, hand)

    @abstractmethod
    def _first(self, answer: Vector) -> Vector:
        """Returns what is held at the start, before the first policy step."""

    def _declare_rejected(self) -> None:
        """Declares the port that comes after the system's own outputs."""
        self.DeclareVectorOutputPort(
            "rejected", 1, self._calc_rejected, prerequisites_of_calc=self._held
        )

    def _start(self, context: Context, state: State) -> EventStatus:
        answer = self.predict(context)
        if not np.all(np.isfinite(answer)):
            return EventStatus.Failed(self, f"first prediction is not finite: {answer}")
        state.get_mutable_discrete_state(0).SetFromVector(np.append(self._first(answer), 0.0))
        return EventStatus.Succeeded()

    def _update(self, context: Context, state: State) -> EventStatus:
        held = np.array(context.get_discrete_state(0).value())
        answer = self.predict(context)
        if np.all(np.isfinite(answer)):
            held[: self._size] = answer
        else:
            held[self._size] += 1
            _log.warning("prediction at %.1f s is not finite: held", context.get_time())
        state.get_mutable_discrete_state(0).SetFromVector(held)
        return EventStatus.Succeeded()

    def _answer(self, context: Context) -> Vector:
        return np.array(context.get_discrete_state(0).value()[: self._size])

    def _calc_rejected(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(0).value()[self._size :])
