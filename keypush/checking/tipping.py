"""Objects whose centre of mass is near the edge of their support polygon."""

import numpy as np
from numpy.typing import NDArray

from keypush.checking.object_scene import with_com
from keypush.objects.model import ObjectModel
from keypush.objects.resting import edge_gaps, room

Array = NDArray[np.float64]


def com_beyond_edge(model: ObjectModel, direction: Array, distance: float) -> ObjectModel:
    """Moves the COM along `direction` until it is `distance` outside its support polygon."""
    start = model.p_OoOcm_O[:2]
    normals, gaps = edge_gaps(model.support_polygon, start)
    return with_com(model, start + direction * room(normals, gaps + distance, direction))


def directions(model: ObjectModel) -> list[Array]:
    """Across two sides, towards a corner, and along nothing in particular."""
    corner = model.support_polygon[0] - model.p_OoOcm_O[:2]
    return [
        np.array([1.0, 0.0]),
        np.array([0.0, -1.0]),
        corner / np.linalg.norm(corner),
        np.array([np.cos(2.2), np.sin(2.2)]),
    ]
