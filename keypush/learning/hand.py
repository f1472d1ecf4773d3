"""The hand state that the network sees."""

import numpy as np
from numpy.typing import NDArray

from keypush.networks.config import HAND_SIZE


def hand_state(X_WE: NDArray[np.floating]) -> NDArray[np.float64]:
    """Returns the hand state (9,) of a tool pose X_WE given as a matrix (4, 4) or (3, 4)."""
    state: NDArray[np.float64] = np.empty(HAND_SIZE)
    state[:3] = X_WE[:3, 3]
    state[3:] = X_WE[:3, :2].T.ravel()
    return state
