"""Fewer faces for the same shape."""

import fast_simplification
import numpy as np
from manifold3d import Manifold

from keypush.objects.importing.manifolds import arrays, as_solid
from keypush.objects.importing.result import Faces, Vertices
from keypush.objects.importing.topology import compact

MAX_SOLID_FACES = 4000
"""Faces of a solid."""
MAX_SURFACE_FACES = 20_000
"""Faces of a surface that repair is at ease with."""
_LITTLE = 0.05
_MUCH = 0.2
_FIRST_TOLERANCE = 5e-4
_LAST_TOLERANCE = 0.03


def decimate_surface(vertices: Vertices, faces: Faces) -> tuple[Vertices, Faces]:
    """Brings a mesh of size 1, closed or not, near or below `MAX_SURFACE_FACES`."""
    if len(faces) <= MAX_SURFACE_FACES:
        return vertices, faces
    vertices, faces = _collapse(vertices, faces, MAX_SURFACE_FACES)
    cells = 256
    while len(faces) > MAX_SURFACE_FACES:
        # Faces that share no edges cannot be collapsed; vertices can be put on a grid.
        vertices, faces = snap(vertices, faces, 1.0 / cells)
        cells //= 2
    return vertices, faces


def decimate_solid(solid: Manifold) -> Manifold | None:
    """Brings a solid of size 1 to `MAX_SOLID_FACES` or returns None if that would spoil it."""
    if solid.num_tri() <= MAX_SOLID_FACES:
        return solid
    collapsed = as_solid(*_collapse(*arrays(solid), MAX_SOLID_FACES))
    if _is_like(collapsed, solid, _LITTLE):
        return collapsed
    tolerance = _FIRST_TOLERANCE
    while tolerance <= _LAST_TOLERANCE:
        fewer = solid.simplify(tolerance)
        if _is_like(fewer, solid, _LITTLE):
            return fewer
        tolerance *= 1.5
    # Thin walls lose volume wherever a curve becomes a chord.
    return collapsed if _is_like(collapsed, solid, _MUCH) else None


def snap(vertices: Vertices, faces: Faces, spacing: float) -> tuple[Vertices, Faces]:
    """Merges the vertices in each cell of a grid and drops the faces that this collapses."""
    cell = np.round(vertices / spacing).astype(np.int64)
    _, first, number = np.unique(cell, axis=0, return_index=True, return_inverse=True)
    faces = number.reshape(-1)[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, kept = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return compact(vertices[first], faces[np.sort(kept)])


def _collapse(vertices: Vertices, faces: Faces, target: int) -> tuple[Vertices, Faces]:
    points, triangles = fast_simplification.simplify(
        np.ascontiguousarray(vertices), faces.astype(np.int32), target_count=target
    )
    return np.asarray(points, dtype=float), np.asarray(triangles, dtype=np.int64)


def _is_like(fewer: Manifold | None, solid: Manifold, change: float) -> bool:
    if fewer is None or fewer.is_empty() or fewer.num_tri() > MAX_SOLID_FACES:
        return False
    return bool(abs(fewer.volume() / solid.volume() - 1) < change)
