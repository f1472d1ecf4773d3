"""KeypointPredictor: a point cloud and a goal become one contact keypoint."""

from typing import override

from pydrake.systems.framework import BasicVector, Context

from keypush.learning.model import KeypointModel
from keypush.systems.scene_system import SceneSystem, Vector


class KeypointPredictor(SceneSystem):
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
    @endsystem

    ``point_cloud``: vector of 3 N, points p_WP in W in m, one after the other.

    ``goal``: vector of 2, goal xy in W in m.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m; its position and the first two
    columns of its rotation are the network's hand state (9).

    ``object_com``: vector of 3, p_WOcm in m; may stay unconnected if the model does not use
    the centre of mass.

    ``keypoint``: vector of 3, p_WK in m, held until the next policy step.

    A keypoint that is not finite is not passed on: the event raises `PolicyError`, which ends
    the simulation.
    """

    def __init__(self, model: KeypointModel, points: int, policy_period: float) -> None:
        """Args: the model; number N of points of the cloud; period in s."""
        super().__init__(model, points, 3, policy_period)
        self.set_name("keypoint_predictor")
        self.DeclareVectorOutputPort(
            "keypoint", 3, self._calc_keypoint, prerequisites_of_calc=self._held
        )

    _answer_name = "keypoint"

    @override
    def _first(self, answer: Vector) -> Vector:
        """A keypoint is there at once."""
        return answer

    def _calc_keypoint(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._answer(context))
