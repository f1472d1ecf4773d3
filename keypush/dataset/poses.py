"""Poses as rows of numbers: quaternion w, x, y, z, then position in m."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation


def rotations(poses: NDArray[np.floating]) -> NDArray[np.float64]:
    """Returns the rotation matrices (n, 3, 3) of poses (n, 7), quaternion first, scalar first."""
    quaternions = np.asarray(poses[:, :4], dtype=np.float64)
    return np.asarray(Rotation.from_quat(quaternions, scalar_first=True).as_matrix())


def hand_states(poses: NDArray[np.floating]) -> NDArray[np.float64]:
    """Returns positions and the first two columns of the rotations, (n, 9), of poses (n, 7)."""
    columns = np.swapaxes(rotations(poses)[:, :, :2], 1, 2).reshape(-1, 6)
    return np.hstack([poses[:, 4:], columns])
