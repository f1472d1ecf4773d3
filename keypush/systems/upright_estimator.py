"""UprightEstimator: noisy clouds become where an object's own vertical points now."""

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from keypush.eval_ports import eval_vector
from keypush.planning.registration import register_rotation

Array = NDArray[np.float64]

REST_SECONDS = 1.0
"""Time in which clouds are averaged to know the object at rest, s: a tool that starts high up and
away from it needs three times as long to be there."""
_NEW = 0.5
"""Share of the newest cloud in the estimate."""
_COUNT, _UP, _SUM = 0, slice(1, 4), 4
_Z = np.array([0.0, 0.0, 1.0])


class UprightEstimator(LeafSystem):
    """Tells where the direction that was vertical in the object at rest points now.

    @system
    name: UprightEstimator
    input_ports:
    - point_cloud
    output_ports:
    - object_up
    @endsystem

    ``point_cloud``: vector of 3 N, points p_WP in W in m, one after the other, fixed on the
    object's surface and always in the same order.

    ``object_up``: vector of 3, that direction in W, a unit vector; Wz in the first
    `REST_SECONDS`. Its angle with Wz is the object's tilt, however the object turned
    about the vertical.

    The clouds of that time are averaged, later ones registered to them, and the answers
    smoothed over about two steps: at 5 mm noise the tilt of an object of 10 cm then comes with a
    deviation of some 0.2 degrees.
    """

    def __init__(self, points: int, policy_period: float) -> None:
        """Args: number N of points of the cloud; period in s."""
        super().__init__()
        self.set_name("upright_estimator")
        self._rest_steps = max(1, round(REST_SECONDS / policy_period))
        self._cloud = self.DeclareVectorInputPort("point_cloud", 3 * points)
        self.DeclareDiscreteState(np.concatenate([[0.0], _Z, np.zeros(3 * points)]))
        self._object_up = self.DeclareVectorOutputPort("object_up", 3, self._calc_up)
        self.DeclarePeriodicUnrestrictedUpdateEvent(policy_period, 0.0, self._update)

    def _estimate(self, context: Context) -> Array:
        """Returns the direction from the context's cloud and what is remembered."""
        held = context.get_discrete_state(0).value()
        if held[_COUNT] < self._rest_steps:
            return _Z
        at_rest = held[_SUM:].reshape(-1, 3) / self._rest_steps
        turn = register_rotation(at_rest, eval_vector(self._cloud, context).reshape(-1, 3))
        up = (1.0 - _NEW) * held[_UP] + _NEW * turn.matrix()[:, 2]
        return np.asarray(up / np.linalg.norm(up))

    def _calc_up(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._estimate(context))

    def _update(self, context: Context, state: State) -> EventStatus:
        values = np.array(context.get_discrete_state(0).value())
        if values[_COUNT] < self._rest_steps:
            values[_COUNT] += 1
            values[_SUM:] += eval_vector(self._cloud, context)
        else:
            values[_UP] = np.asarray(self._object_up.Eval(context))
        state.get_mutable_discrete_state(0).SetFromVector(values)
        return EventStatus.Succeeded()
