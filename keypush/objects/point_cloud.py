"""The cloud that a sensor measures of an object: points of its surface, with noise.

Everything is drawn from seeds, so that a cloud can be had again from the object's pose.
"""

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform

from keypush.objects.model import ObjectModel
from keypush.seeding import make_generator

Array = NDArray[np.float64]


def pose_to_vector(X: RigidTransform) -> Array:
    """Returns quaternion w, x, y, z (w >= 0) and position of a pose, shape (7,)."""
    wxyz = X.rotation().ToQuaternion().wxyz()
    return np.concatenate([wxyz if wxyz[0] >= 0 else -wxyz, X.translation()])


def pose_from_vector(pose: Array) -> RigidTransform:
    """Returns the pose that `pose_to_vector` made (7,) of."""
    return RigidTransform(Quaternion(pose[:4]), pose[4:])


def sensed_points(model: ObjectModel, count: int, seed: int) -> Array:
    """Returns the points (count, 3) in O of an object's surface that a scenario's sensor sees."""
    return model.surface_points(count, make_generator(seed, 0, f"surface_points:{model.name}"))


def measured_cloud(
    p_OP: Array, pose: Array, deviation: float, seed: int, episode: int, step: int
) -> Array:
    """Returns what the sensor measures of points on the object's surface.

    Args:
        p_OP: (N, 3) points in O, m.
        pose: (7,) X_WO as `pose_to_vector` returns it. Not a `RigidTransform`, because that is
            what frames store, and a cloud rebuilt from them is to have the same bits.
        deviation: of the noise in every coordinate, m.
        seed: the scenario's.
        episode: number of the episode.
        step: policy step.

    Returns:
        (N, 3) points p_WP, m.
    """
    noise = make_generator(seed, episode, "point_cloud", step).normal(
        scale=deviation, size=p_OP.shape
    )
    X_WO = pose_from_vector(pose)
    return np.asarray(p_OP @ X_WO.rotation().matrix().T + X_WO.translation() + noise)
