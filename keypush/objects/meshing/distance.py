"""How far two surfaces are from each other."""

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]

_SPACING = 1e-3
"""Distance between the points whose distance is measured, m."""
_TARGET_SPACING = 5e-4
"""Distance between those to which it is measured, m: an error of 0.06 mm at a distance of 1 mm."""


def hausdorff(first: trimesh.Trimesh, second: trimesh.Trimesh) -> float:
    """Returns the Hausdorff distance of two surfaces, m, from dense samples of both."""
    return max(_largest_distance(first, second), _largest_distance(second, first))


def _largest_distance(here: trimesh.Trimesh, there: trimesh.Trimesh) -> float:
    tree = cKDTree(_samples(there, _TARGET_SPACING))
    return float(tree.query(_samples(here, _SPACING))[0].max())


def _samples(mesh: trimesh.Trimesh, spacing: float) -> Array:
    """Points in rows along the longest side of every face, and so at its corners too."""
    triangles = np.asarray(mesh.vertices)[np.asarray(mesh.faces)]
    sides = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
    first = sides.argmax(axis=1)
    order = (first[:, None] + np.arange(3)) % 3
    triangles = np.take_along_axis(triangles, order[:, :, None], axis=1)
    longest = sides.max(axis=1)
    height = 2 * np.asarray(mesh.area_faces) / np.maximum(longest, 1e-12)
    counts = np.maximum(1, np.ceil(np.column_stack([longest, height]) / spacing)).astype(int)
    points = []
    for along, rows in np.unique(counts, axis=0):
        row, place = np.meshgrid(np.arange(rows + 1) / rows, np.arange(along + 1) / along)
        v, u = row.ravel(), (place * (1 - row)).ravel()
        weights = np.column_stack([1 - u - v, u, v])
        chosen = (counts == (along, rows)).all(axis=1)
        points.append(np.einsum("wk,fkd->fwd", weights, triangles[chosen]).reshape(-1, 3))
    return np.concatenate(points)
