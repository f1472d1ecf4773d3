"""Objects whose centre of mass is near the edge of their support polygon."""

import numpy as np
from numpy.typing import NDArray

from keypush.checking.object_scene import with_com
from keypush.objects.model import ObjectModel

Array = NDArray[np.float64]


def com_beyond_edge(model: ObjectModel, direction: Array, distance: float) -> ObjectModel:
    """Moves the COM along `direction` until it is `distance` outside its support polygon."""
    polygon, start = model.support_polygon, model.p_OoOcm_O[:2]
    normals = _outward_normals(polygon)
    gap = np.sum(normals * (polygon - start), axis=1) + distance
    speed = normals @ direction
    return with_com(model, start + direction * np.min(gap[speed > 1e-9] / speed[speed > 1e-9]))


def directions(model: ObjectModel) -> list[Array]:
    """Across two sides, towards a corner, and along nothing in particular."""
    corner = model.support_polygon[0] - model.p_OoOcm_O[:2]
    return [
        np.array([1.0, 0.0]),
        np.array([0.0, -1.0]),
        corner / np.linalg.norm(corner),
        np.array([np.cos(2.2), np.sin(2.2)]),
    ]


def _outward_normals(polygon: Array) -> Array:
    edge = np.roll(polygon, -1, axis=0) - polygon
    normal = np.column_stack([edge[:, 1], -edge[:, 0]])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
