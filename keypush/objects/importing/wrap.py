"""A solid around a surface that has no inside of its own, or holes too large to close."""

import numpy as np
import trimesh
from manifold3d import Manifold
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import cKDTree

from keypush.objects.importing.manifolds import as_mesh
from keypush.objects.importing.result import Faces, Vertices

CELLS = 48
"""Cells of the grid along the longest side."""
_REACH = 0.75
"""How far, in cells, the solid goes beyond the surface: walls are twice that thick.

From 0.5 on a wall has no gaps; the rest is for the distance to samples of the surface.
"""
_MARGIN = 3
_SAMPLES = 150_000


def wrap(vertices: Vertices, faces: Faces, cells: int = CELLS) -> Manifold:
    """Returns all that lies within 3/4 of a cell of a surface or that it shuts off from outside.

    With 48 cells along the longest side of the bounding box every wall gets about 3 % of
    that thick, gaps up to as much are closed, and outsides move outwards by half of it.

    Args:
        vertices: (n, 3).
        faces: (m, 3), in any condition.
        cells: along the longest side.
    """
    mesh = as_mesh(vertices, faces)
    spacing = float(mesh.extents.max()) / cells
    origin = mesh.bounds[0] - _MARGIN * spacing
    shape = np.ceil(mesh.extents / spacing).astype(int) + 2 * _MARGIN + 1
    depth = _depth(mesh, origin, spacing, tuple(shape.tolist()))
    far = origin + (shape - 1) * spacing
    field = _Interpolation(depth, origin, spacing)
    return Manifold.level_set(field, [*origin.tolist(), *far.tolist()], spacing)


def _depth(
    mesh: trimesh.Trimesh, origin: Vertices, spacing: float, shape: tuple[int, ...]
) -> NDArray[np.float64]:
    """Returns how deep grid points lie in the solid: positive inside, negative outside."""
    # A fixed seed: the same file gives the same solid.
    samples = trimesh.sample.sample_surface(mesh, _SAMPLES, seed=0)[0]
    samples = np.vstack([samples, mesh.vertices])
    points = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    reach = _REACH * spacing
    limit = (_MARGIN + 1) * spacing
    distance, _ = cKDTree(samples).query(
        points.reshape(-1, 3) * spacing + origin, distance_upper_bound=limit
    )
    distance = np.minimum(distance, limit).reshape(shape)
    regions, _ = ndimage.label(distance > reach)
    shut_off = (regions != regions[0, 0, 0]) & (distance > reach)
    depth: NDArray[np.float64] = np.where(shut_off, reach + distance, reach - distance)
    return depth


class _Interpolation:
    """Trilinear interpolation of a grid, point by point as manifold3d asks for it."""

    def __init__(self, values: NDArray[np.float64], origin: Vertices, spacing: float) -> None:
        # Lists: reading one number of an array takes ten times as long.
        self._values = values.tolist()
        self._last = [n - 2 for n in values.shape]
        self._origin = origin.tolist()
        self._spacing = spacing

    def __call__(self, x: float, y: float, z: float) -> float:
        """Returns the value at a point."""
        ox, oy, oz = self._origin
        x, y, z = (x - ox) / self._spacing, (y - oy) / self._spacing, (z - oz) / self._spacing
        i = min(max(int(x), 0), self._last[0])
        j = min(max(int(y), 0), self._last[1])
        k = min(max(int(z), 0), self._last[2])
        x, y, z = x - i, y - j, z - k
        near, far = self._values[i], self._values[i + 1]
        a, b, c, d = near[j], near[j + 1], far[j], far[j + 1]
        low = (a[k] * (1 - y) + b[k] * y) * (1 - x) + (c[k] * (1 - y) + d[k] * y) * x
        k += 1
        high = (a[k] * (1 - y) + b[k] * y) * (1 - x) + (c[k] * (1 - y) + d[k] * y) * x
        return float(low * (1 - z) + high * z)
