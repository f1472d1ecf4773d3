"""How far the closed fingers reach below the tool tip."""

import math

_BEYOND = 0.0088
"""How far the fingers' box reaches beyond E along Ez, m; see the model of the Panda."""
_HALF_DEPTH, _HALF_WIDTH = 0.010, 0.0175
"""Half of the box across the finger row and along it, m."""


def lowest_corner(pitch: float, wrist_yaw: float) -> float:
    """Returns how far the lowest corner of the fingers lies below E, m.

    Args:
        pitch: angle of Ez below the table plane, rad.
        wrist_yaw: angle of the finger row out of the plane of the push, rad.
    """
    half = _HALF_WIDTH * math.cos(wrist_yaw) + _HALF_DEPTH * math.sin(wrist_yaw)
    return _BEYOND * math.sin(pitch) + half * math.cos(pitch)
