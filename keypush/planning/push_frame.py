"""The tool's orientation for a push direction, and the rotations that lead to it."""

import math

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RotationMatrix

Array = NDArray[np.float64]


def push_direction(p_from_W: Array, goal_W: Array) -> Array:
    """Returns the horizontal unit vector (3,) from a point towards the goal.

    At the goal itself any direction serves; Wx is returned.

    Args:
        p_from_W: (2,) or (3,), m.
        goal_W: (2,), m.
    """
    offset = goal_W[:2] - p_from_W[:2]
    length = float(np.hypot(offset[0], offset[1]))
    if length < 1e-9:
        return np.array([1.0, 0.0, 0.0])
    return np.array([offset[0] / length, offset[1] / length, 0.0])


def left_of(d_W: Array) -> Array:
    """Returns the horizontal unit vector to the left of a horizontal direction: z x d."""
    return np.array([-d_W[1], d_W[0], 0.0])


def tool_rotation(
    d_W: Array, pitch: float, side: int, wrist_yaw: float = math.pi / 2
) -> RotationMatrix:
    """Returns R_WE of a tool that faces d_W, pitched below the table plane.

    Ez points along d_W and down by `pitch`. Ey, the finger row, lies across the push where the
    wrist is turned by a right angle, to the left of d_W for side +1 and to its right for side -1.
    The thesis (section 4.3) turns Ex and Ey but not Ez, which leaves no rotation, so all three
    axes turn here; it puts the finger row in the push plane (wrist_yaw 0), where the palm hits
    table and tall objects.

    Args:
        d_W: (3,) horizontal unit vector.
        pitch: angle of Ez below the table plane, rad.
        side: +1 or -1, which are half a turn about Ez apart.
        wrist_yaw: angle of the finger row out of the push plane, rad.
    """
    c, s = math.cos(pitch), math.sin(pitch)
    z_axis = c * d_W - np.array([0.0, 0.0, s])
    in_plane = s * d_W + np.array([0.0, 0.0, c])
    y_axis = side * (math.cos(wrist_yaw) * in_plane + math.sin(wrist_yaw) * left_of(d_W))
    return RotationMatrix(np.column_stack([np.cross(y_axis, z_axis), y_axis, z_axis]))


def rotation_vector(R_WA: RotationMatrix, R_WB: RotationMatrix) -> Array:
    """Returns the axis-angle vector (3,) in W that turns A into B: exp([v]x) R_WA = R_WB.

    The angle lies in [0, pi]: the logarithm map with w >= 0, so that it has no 2 pi jumps.
    """
    axis_angle = (R_WB @ R_WA.inverse()).ToAngleAxis()
    return np.asarray(axis_angle.axis() * axis_angle.angle())
