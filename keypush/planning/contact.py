"""Where to touch an object so that the push goes through its centre of mass."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from keypush.planning.push_frame import left_of, push_direction

Array = NDArray[np.float64]

_HALF_WIDTH = 0.02
"""Half the finger's width and its lateral error, m."""
_BAND = (0.012, 0.04)
"""Heights at which the pitched finger can touch, m; the lower is the contact's own."""


def push_through_com(
    p_OP: Array, X_WO: RigidTransform, p_WOcm: Array, goal_W: Array
) -> tuple[Array, Array, float]:
    """Returns contact p_WK (3,), direction d_W (3,) and distance to the goal of the expert's push.

    Args:
        p_OP: (N, 3) points on the object's surface in O, m.
        X_WO: pose of the object.
        p_WOcm: (3,) centre of mass in W, from which the distance counts.
        goal_W: (2,) goal xy in W, m.
    """
    p_WP = p_OP @ X_WO.rotation().matrix().T + X_WO.translation()
    d_W = push_direction(p_WOcm, goal_W)
    return finger_contact(p_WP, p_WOcm, d_W), d_W, float(np.hypot(*(goal_W - p_WOcm[:2])))


def finger_contact(p_WP: Array, p_WOcm: Array, d_W: Array) -> Array:
    """Returns the `analytic_contact` of the pitched finger, (3,); arguments are the same."""
    return analytic_contact(p_WP, p_WOcm, d_W, _HALF_WIDTH, _BAND)


def analytic_contact(
    p_WP: Array, p_WOcm: Array, d_W: Array, half_width: float, band: tuple[float, float]
) -> Array:
    """Returns the contact point p_WK = c - r d, (3,), on the far side from the goal.

    r is the object's own extent along -d within the finger's width and height, instead of
    the thesis' bounding radius, which over-estimates most shapes (and its sign is a slip:
    the contact lies behind the object).

    Args:
        p_WP: (N, 3) points on the object's surface in W, m.
        p_WOcm: (3,) centre of mass in W.
        d_W: (3,) horizontal unit vector towards the goal.
        half_width: half the width across the push in which points count, m.
        band: lowest and highest z in W in which points count, m.
    """
    left = left_of(d_W)
    # Columns: across the push, against it, up.
    axes = np.array([[left[0], -d_W[0], 0.0], [left[1], -d_W[1], 0.0], [0.0, 0.0, 1.0]])
    across, depth, z = ((p_WP - [p_WOcm[0], p_WOcm[1], 0.0]) @ axes).T
    near = np.abs(across) <= half_width
    touchable = near & (z >= band[0]) & (z <= band[1])
    for mask in (touchable, near, np.ones_like(near)):
        if mask.any():
            break
    r = max(float(depth[mask].max()), 0.0)
    contact = p_WOcm - r * d_W
    contact[2] = min(max(band[0], 0.0), band[1])
    return np.asarray(contact)
