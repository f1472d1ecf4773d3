"""Inputs and targets of the thesis' networks, scaled to about [-1, 1].

CORN scales positions about a point above the table (its env/arm_env.py): (p - (0, 0, 0.55)) / 0.4,
there with the table's top at z = 0.4; ours is at 0.
"""

import numpy as np
from numpy.typing import NDArray

CENTRE_HEIGHT = 0.15
"""Height above the table of the point that becomes 0, m."""
LENGTH = 0.4
"""Distance from it that becomes 1, m."""

Array = NDArray[np.floating]


def normalise_positions(p_W: Array) -> Array:
    """Scales positions (..., 3), or xy (..., 2), in W in m; the argument stays as it is."""
    scaled = p_W / LENGTH
    scaled[..., 2:] -= CENTRE_HEIGHT / LENGTH
    return scaled


def denormalise_positions(scaled: Array) -> Array:
    """The inverse of `normalise_positions`."""
    p_W = scaled * LENGTH
    p_W[..., 2:] += CENTRE_HEIGHT
    return p_W


def normalise_hand(hand: Array) -> Array:
    """Scales the position of hand states (..., 9); the two axes are unit vectors already."""
    return np.concatenate([normalise_positions(hand[..., :3]), hand[..., 3:]], axis=-1)
