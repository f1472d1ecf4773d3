"""An object alone on the table that can be thrown, and what Coulomb says of it."""

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.math import SpatialVelocity

from keypush.checking.object_scene import ObjectScene
from keypush.scenario import ObjectConfig, TableConfig

GRAVITY = 9.81


def _combined(a: float, b: float) -> float:
    """What Drake makes of two coefficients of friction."""
    return 2 * a * b / (a + b)


FRICTION = _combined(ObjectConfig().friction, TableConfig().friction)
"""Between object and table."""


class ThrownScene(ObjectScene):
    """An object that can be given a velocity."""

    def throw(self, v_WO: NDArray[np.float64]) -> None:
        """Gives the object a velocity without spin."""
        velocity = SpatialVelocity(np.zeros(3), v_WO)
        self.plant.SetFreeBodySpatialVelocity(self.context, self.body, velocity)
        self.simulator.Initialize()

    def velocity(self) -> NDArray[np.float64]:
        """v_WO."""
        V_WO = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.body)
        return np.asarray(V_WO.translational())
