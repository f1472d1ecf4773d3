"""What the systems share that ask a model about the scene: inputs, and what is not finite."""

from abc import abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, EventStatus, LeafSystem, State

from keypush.eval_ports import eval_abstract, eval_vector
from keypush.learning.hand import hand_state
from keypush.learning.model import PolicyError, PolicyModel

Vector = NDArray[np.float64]


class SceneSystem(LeafSystem):
    """Base of the systems that hold a model's answer for one policy step.

    The state is the held answer. It updates in unrestricted events, which Drake handles before
    discrete ones (see `StagedPlanner`). Where there is no answer that can be used these raise
    `PolicyError`, and leave the state as it was.
    """

    _answer_name: ClassVar[str]
    """What the model answers with, in messages."""

    def __init__(self, model: PolicyModel, points: int, size: int, policy_period: float) -> None:
        """Args: the model; points of the cloud; numbers of an answer; period in s."""
        super().__init__()
        self._model = model
        self._cloud = self.DeclareVectorInputPort("point_cloud", 3 * points)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._tool_pose = self.DeclareAbstractInputPort("tool_pose", Value(RigidTransform()))
        self._com = self.DeclareVectorInputPort("object_com", 3)
        self._held = {self.discrete_state_ticket(self.DeclareDiscreteState(size))}
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

    def _start(self, context: Context, state: State) -> EventStatus:
        first = self._first(self._finite_answer(context))
        state.get_mutable_discrete_state(0).SetFromVector(first)
        return EventStatus.Succeeded()

    def _update(self, context: Context, state: State) -> EventStatus:
        state.get_mutable_discrete_state(0).SetFromVector(self._finite_answer(context))
        return EventStatus.Succeeded()

    def _finite_answer(self, context: Context) -> Vector:
        """Asks the model.

        Raises:
            PolicyError: the answer is not finite, or the model itself raises it.
        """
        answer = self.predict(context)
        if not np.all(np.isfinite(answer)):
            raise PolicyError(f"{self._answer_name} is not finite")
        return answer

    def _answer(self, context: Context) -> Vector:
        return np.array(context.get_discrete_state(0).value())
