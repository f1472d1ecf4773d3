"""KeypointPredictor: a point cloud and a goal become one contact keypoint."""

import logging
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from keypush.eval_ports import eval_abstract, eval_vector
from keypush.learning.hand import hand_state

if TYPE_CHECKING:
    from keypush.learning.predict import KeypointModel

_log = logging.getLogger(__name__)


class KeypointPredictor(LeafSystem):
    """Predicts where to touch the object, once per policy step.

    @system
    name: KeypointPredictor
    input_ports:
    - point_cloud
    - goal
    - tool_pose
    - object_com (optional)
    output_ports:
    - keypoint
    - rejected
    @endsystem

    ``point_cloud``: vector of 3 N, points p_WP in W in m, one after the other.

    ``goal``: vector of 2, goal xy in W in m.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m; its position and the first two
    columns of its rotation are the network's hand state (9).

    ``object_com``: vector of 3, p_WOcm in m; may stay unconnected if the model does not use
    the centre of mass.

    ``keypoint``: vector of 3, p_WK in m, held until the next policy step.

    ``rejected``: vector of 1, how many predictions of this episode were not finite.

    A prediction that is not finite is logged, counted and not passed on: the last finite
    one is held. If the first one is not finite the event fails, and with it the simulation.
    """

    def __init__(self, model: "KeypointModel", points: int, policy_period: float) -> None:
        """Args: the model; number N of points of the cloud; period in s."""
        super().__init__()
        self.set_name("keypoint_predictor")
        self._model = model
        self._cloud = self.DeclareVectorInputPort("point_cloud", 3 * points)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._tool_pose = self.DeclareAbstractInputPort("tool_pose", Value(RigidTransform()))
        self._com = self.DeclareVectorInputPort("object_com", 3)
        held = {self.discrete_state_ticket(self.DeclareDiscreteState(4))}
        self.DeclareVectorOutputPort("keypoint", 3, self._calc_keypoint, prerequisites_of_calc=held)
        self.DeclareVectorOutputPort("rejected", 1, self._calc_rejected, prerequisites_of_calc=held)
        self.DeclareInitializationUnrestrictedUpdateEvent(self._start)
        self.DeclarePeriodicUnrestrictedUpdateEvent(policy_period, 0.0, self._update)

    def predict(self, context: Context) -> NDArray[np.float64]:
        """Returns the model's prediction p_WK (3,) for the inputs, finite or not."""
        X_WE: RigidTransform = eval_abstract(self._tool_pose, context)
        hand = hand_state(X_WE.GetAsMatrix34())
        com = eval_vector(self._com, context) if self._com.HasValue(context) else None
        cloud = eval_vector(self._cloud, context).reshape(-1, 3)
        return self._model.predict(cloud, eval_vector(self._goal, context), com, hand)

    def _start(self, context: Context, state: State) -> EventStatus:
        keypoint = self.predict(context)
        if not np.all(np.isfinite(keypoint)):
            return EventStatus.Failed(self, f"first prediction is not finite: {keypoint}")
        state.get_mutable_discrete_state(0).SetFromVector(np.append(keypoint, 0.0))
        return EventStatus.Succeeded()

    def _update(self, context: Context, state: State) -> EventStatus:
        held = np.array(context.get_discrete_state(0).value())
        keypoint = self.predict(context)
        if np.all(np.isfinite(keypoint)):
            held[:3] = keypoint
        else:
            held[3] += 1
            _log.warning("prediction at %.1f s is not finite: held", context.get_time())
        state.get_mutable_discrete_state(0).SetFromVector(held)
        return EventStatus.Succeeded()

    def _calc_keypoint(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(0).value()[:3])

    def _calc_rejected(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(0).value()[3:])
