"""The two boxes of the hand that touch things, as the model of the Panda has them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Box:
    """A box with its axes along those of the tool frame E."""

    centre: tuple[float, float, float]
    """In E, m."""
    size: tuple[float, float, float]
    """m."""

    def distance(self, p_E: Array) -> float:
        """Returns the distance of the nearest of the points (n, 3) in E, m; 0 inside."""
        beyond = np.abs(p_E - np.array(self.centre)) - np.array(self.size) / 2
        return float(np.linalg.norm(np.clip(beyond, 0.0, None), axis=1).min())


PALM = Box((0.0, 0.0, -0.0834), (0.055, 0.204, 0.092))
"""The hand without its fingers."""
FINGERS = Box((0.0, 0.0, -0.0147), (0.020, 0.035, 0.047))
"""Both, closed."""
