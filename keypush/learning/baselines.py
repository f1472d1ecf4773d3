"""Keypoints without learning."""

from typing import override

import numpy as np

from keypush.learning.model import KeypointModel, Seen, Vector
from keypush.planning.contact import finger_contact
from keypush.planning.push_frame import push_direction


class CentroidKeypoint(KeypointModel):
    """The cloud's centroid."""

    @property
    @override
    def uses_com(self) -> bool:
        """False."""
        return False

    @override
    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the mean of the cloud; see `KeypointModel.predict`."""
        centroid: Vector = np.mean(cloud_W, axis=0, dtype=float)
        return centroid


class GeometricKeypoint(KeypointModel):
    """The expert's contact, with the noisy cloud in place of the true surface.

    That is the point of the cloud's outline, within the finger's reach, on the ray from the
    object's centre away from the goal.
    """

    def __init__(self, *, uses_com: bool) -> None:
        """Args: whether the centre is the true centre of mass, or the cloud's centroid."""
        self._uses_com = uses_com

    @property
    @override
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""
        return self._uses_com

    @override
    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the contact; see `KeypointModel.predict`.

        Raises:
            RuntimeError: the centre of mass is used, but not given.
        """
        if not self._uses_com:
            centre = np.mean(cloud_W, axis=0, dtype=float)
        elif com_W is None:
            raise RuntimeError("object_com has no value; this model uses the centre of mass")
        else:
            centre = np.asarray(com_W, dtype=float)
        cloud, goal = np.asarray(cloud_W, dtype=float), np.asarray(goal_W, dtype=float)
        return finger_contact(cloud, centre, push_direction(centre, goal))
