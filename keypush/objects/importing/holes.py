"""Closes holes: loops of edges that have a face on one side only."""

import numpy as np
from manifold3d import triangulate

from keypush.objects.importing.result import Faces, Vertices
from keypush.objects.importing.topology import Indices, face_areas

_LARGEST_AREA = 0.2
"""Of the closed surface: one face of a cube is a hole, the mouth of a bowl is not."""
_SMALL = 0.15
"""Extent of a hole, of a mesh of size 1, that is closed whatever its shape."""
_UNEVEN = 0.25
"""Of its extent, how far the edge of a larger hole may be from a plane."""


def fill_holes(vertices: Vertices, faces: Faces) -> tuple[Faces, int] | None:
    """Closes the holes of one oriented piece.

    Args:
        vertices: (n, 3), of a mesh of size 1.
        faces: (m, 3), neighbours agree.

    Returns:
        All faces and the number of holes closed, or None if a hole is too large or uneven.
    """
    loops = boundary_loops(faces)
    if loops is None:
        return None
    caps = [_cap(vertices, loop) for loop in loops]
    patches = [cap for cap in caps if cap is not None]
    if len(patches) < len(caps):
        return None
    filled = np.vstack([faces, *patches])
    areas = face_areas(vertices, filled)
    if areas[len(faces) :].sum() > _LARGEST_AREA * areas.sum():
        return None
    return filled, len(loops)


def boundary_loops(faces: Faces) -> list[Indices] | None:
    """Returns the edges without a face beyond them as loops of vertices, or None if they are none.

    A loop runs along a hole such that a face over it, with the same vertices in the same
    order, has the direction of its neighbours.
    """
    ends = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = int(faces.max()) + 1
    key, back = ends[:, 0] * size + ends[:, 1], ends[:, 1] * size + ends[:, 0]
    follows: dict[int, list[int]] = {}
    for end, start in ends[~np.isin(key, back)].tolist():
        follows.setdefault(start, []).append(end)
    loops = []
    while follows:
        path = [next(iter(follows))]
        seen = {path[0]: 0}
        while path:
            options = follows.get(path[-1])
            if options is None:
                return None
            vertex = options.pop()
            if not options:
                del follows[path[-1]]
            if vertex in seen:
                # Cut where it meets itself, so that no loop passes a vertex twice.
                at = seen[vertex]
                loops.append(np.array(path[at:], dtype=np.int64))
                for left in path[at:]:
                    del seen[left]
                path = path[:at]
                if not path:
                    break
            seen[vertex] = len(path)
            path.append(vertex)
    return loops


def _cap(vertices: Vertices, loop: Indices) -> Faces | None:
    """Returns the faces (k, 3) that close a loop of k + 2 vertices, or None if it is uneven."""
    if len(loop) < 3:
        return None
    points = vertices[loop]
    centre = points.mean(axis=0)
    around = points - centre
    # Newell's formula: twice the area that the loop spans, as a vector.
    normal = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(normal)
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    if len(loop) == 3:
        return loop.reshape(1, 3)
    if length < 1e-12:
        return None
    normal /= length
    if extent > _SMALL and np.abs(around @ normal).max() > _UNEVEN * extent:
        return None
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    plane = np.column_stack([around @ first, around @ np.cross(normal, first)])
    triangles = np.asarray(triangulate([plane]), dtype=np.int64)
    return loop[triangles] if len(triangles) == len(loop) - 2 else None
