"""Poses as rows of numbers: quaternion w, x, y, z, then position in m."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

POSES = ("observation.object_pose", "observation.tool_pose")
"""The fields that are poses."""
QUATERNION_ERROR = 1e-6
"""By how much the norm of a stored quaternion may be off 1."""


def quaternion_errors(poses: NDArray[np.floating]) -> NDArray[np.float64]:
    """Returns by how much the quaternions of poses (n, 7) are off norm 1, (n,)."""
    norms = np.linalg.norm(poses[:, :4].astype(np.float64), axis=1)
    return np.asarray(np.abs(norms - 1))


def rotations(poses: NDArray[np.floating]) -> NDArray[np.float64]:
    """Returns the rotation matrices (n, 3, 3) of poses (n, 7), quaternion first, scalar first."""
    quaternions = np.asarray(poses[:, :4], dtype=np.float64)
    return np.asarray(Rotation.from_quat(quaternions, scalar_first=True).as_matrix())


def hand_states(poses: NDArray[np.floating]) -> NDArray[np.float64]:
    """Returns positions and the first two columns of the rotations, (n, 9), of poses (n, 7)."""
    columns = np.swapaxes(rotations(poses)[:, :, :2], 1, 2).reshape(-1, 6)
    return np.hstack([poses[:, 4:], columns])
