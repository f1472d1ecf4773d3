"""How far the closed fingers reach below the tool tip."""

import math

from keypush.robot.hand_shape import FINGERS

_BEYOND = FINGERS.centre[2] + FINGERS.size[2] / 2
"""How far the fingers reach beyond E along Ez, m."""


def lowest_corner(pitch: float, wrist_yaw: float) -> float:
    """Returns how far the lowest corner of the fingers lies below E, m.

    Args:
        pitch: angle of Ez below the table plane, rad.
        wrist_yaw: angle of the finger row out of the plane of the push, rad.
    """
    across, along, _ = FINGERS.size
    half = (along * math.cos(wrist_yaw) + across * math.sin(wrist_yaw)) / 2
    return _BEYOND * math.sin(pitch) + half * math.cos(pitch)
