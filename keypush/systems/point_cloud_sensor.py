"""PointCloudSensor: the object's pose becomes a noisy point cloud in the world frame."""

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from keypush.eval_ports import eval_abstract
from keypush.objects.point_cloud import measured_cloud, pose_to_vector
from keypush.systems.episode_seed import declare_episode_seed, episode_of, policy_step


class PointCloudSensor(LeafSystem):
    """Measures a noisy cloud of N points that are fixed on the object's surface.

    @system
    name: PointCloudSensor
    input_ports:
    - object_pose
    output_ports:
    - point_cloud
    @endsystem

    ``object_pose``: abstract `RigidTransform`, X_WO in m.

    ``point_cloud``: vector of 3 N, the points p_WP in W in m, one after the other (reshape
    to (N, 3)). Gaussian noise of the given deviation is added to every coordinate in W; it
    is redrawn each policy step and constant in W within a step, however the object turns.

    The noise is a function of seed, episode and policy step alone (parameter
    [seed, episode]); the system has no state. So `measured_cloud` gives the same cloud again.
    """

    def __init__(self, p_OP: NDArray[np.float64], deviation: float, policy_period: float) -> None:
        """Args: surface points (N, 3) in O in m; noise in m; period of the noise in s."""
        super().__init__()
        self.set_name("point_cloud_sensor")
        self._p_OP_O = np.asarray(p_OP, dtype=float)
        self._deviation = deviation
        self._period = policy_period
        declare_episode_seed(self)
        self._pose = self.DeclareAbstractInputPort("object_pose", Value(RigidTransform()))
        self.DeclareVectorOutputPort("point_cloud", self._p_OP_O.size, self._calc_point_cloud)

    def _calc_point_cloud(self, context: Context, output: BasicVector) -> None:
        X_WO: RigidTransform = eval_abstract(self._pose, context)
        step = policy_step(context, self._period)
        p_WP = measured_cloud(
            self._p_OP_O, pose_to_vector(X_WO), self._deviation, *episode_of(context), step
        )
        output.SetFromVector(p_WP.ravel())
