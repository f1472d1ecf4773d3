"""How a rigid body has turned, from two measurements of the same points of it."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RotationMatrix
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def register_rotation(p_WP: Array, p_WP_now: Array) -> RotationMatrix:
    """Returns the rotation that takes the first points to the second ones, whatever their shift.

    The least-squares fit of Kabsch (1976, 10.1107/S0567739476001873) by `scipy`. With N points,
    noise s in every coordinate of the second ones, and r the root mean square of their distances
    from an axis, the angle about it comes out with a deviation of s / (r sqrt(N)).

    Args:
        p_WP: (N, 3) points, m.
        p_WP_now: (N, 3) the same points in the same order, m.
    """
    first, second = (points - points.mean(axis=0) for points in (p_WP, p_WP_now))
    rotation, _ = Rotation.align_vectors(second, first)
    return RotationMatrix(rotation.as_matrix())
