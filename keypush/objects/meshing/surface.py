"""Surface: a closed triangle mesh whose edges can be collapsed and split.

Every face has a label: the number of the resting plane in which it lies, or FREE.
"""

from collections.abc import Iterator

import numpy as np
import trimesh
from numpy.typing import NDArray

Array = NDArray[np.float64]
Face = tuple[int, int, int]

FREE = -1
_LEAST_COSINE = 0.2
"""No face may turn by more than this when an edge collapses, lest the surface folds."""
_NOTHING = 1e-20
"""Square of twice the area of a face that has none, m^4."""


class Surface:
    """A closed, manifold, labelled triangle mesh under edit; ids stay what they are."""

    def __init__(self, mesh: trimesh.Trimesh, labels: NDArray[np.int64]) -> None:
        """Args: closed mesh, and a label for each of its faces."""
        self.points: list[Array] = [np.array(p) for p in np.asarray(mesh.vertices)]
        self.faces: dict[int, Face] = {}
        self.labels: dict[int, int] = {}
        self.around: list[set[int]] = [set() for _ in self.points]
        self._next = 0
        for (a, b, c), label in zip(mesh.faces.tolist(), labels.tolist(), strict=True):
            self.add_face((a, b, c), label)

    def add_point(self, point: Array) -> int:
        """Adds a point and returns its id."""
        self.points.append(np.array(point, dtype=float))
        self.around.append(set())
        return len(self.points) - 1

    def add_face(self, face: Face, label: int) -> None:
        """Adds a face."""
        self.faces[self._next], self.labels[self._next] = face, label
        for v in face:
            self.around[v].add(self._next)
        self._next += 1

    def remove_face(self, index: int) -> None:
        """Removes a face."""
        for v in self.faces.pop(index):
            self.around[v].discard(index)
        del self.labels[index]

    def neighbours(self, v: int) -> set[int]:
        """Returns the vertices that share an edge with v."""
        return {w for f in self.around[v] for w in self.faces[f]} - {v}

    def planes_of(self, v: int) -> set[int]:
        """Returns the labels of the resting planes whose faces meet at v."""
        return {self.labels[f] for f in self.around[v]} - {FREE}

    def edges(self) -> Iterator[tuple[int, int]]:
        """Yields every edge once."""
        for a, b, c in self.faces.values():
            for u, v in ((a, b), (b, c), (c, a)):
                if u < v:
                    yield u, v

    def normals_area(self, face: Face, moved: dict[int, Array] | None = None) -> Array:
        """Returns the normal of a face times twice its area, with some vertices moved."""
        moved = moved or {}
        a, b, c = (moved.get(v, self.points[v]) for v in face)
        u, w = b - a, c - a
        return np.array([u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2],
                         u[0] * w[1] - u[1] * w[0]])  # fmt: skip

    def can_collapse(self, u: int, v: int, point: Array) -> bool:
        """Whether u and v may become one vertex at `point`: still manifold, nothing folds."""
        shared = self.around[u] & self.around[v]
        if len(shared) != 2:
            return False
        opposite = {w for f in shared for w in self.faces[f]} - {u, v}
        near_u, near_v = self.neighbours(u), self.neighbours(v)
        if near_u & near_v != opposite or len(near_u | near_v) <= 4:
            return False  # two sheets would touch, or a tetrahedron would lose its inside
        for vertex in (u, v):
            for f in self.around[vertex] - shared:
                before = self.normals_area(self.faces[f])
                if before @ before < _NOTHING:
                    continue  # a sliver faces anywhere
                after = self.normals_area(self.faces[f], {vertex: point})
                product = float(before @ after)
                limit = _LEAST_COSINE * float(np.sqrt((before @ before) * (after @ after)))
                if product <= limit:
                    return False
        return True

    def collapse(self, u: int, v: int, point: Array) -> None:
        """Makes u and v one vertex, v, at `point`."""
        for f in self.around[u] & self.around[v]:
            self.remove_face(f)
        for f in list(self.around[u]):
            a, b, c = (v if w == u else w for w in self.faces[f])
            self.faces[f] = (a, b, c)
            self.around[v].add(f)
        self.around[u].clear()
        self.points[v] = np.array(point, dtype=float)

    def split(self, u: int, v: int, point: Array) -> int:
        """Puts a new vertex into the edge (u, v); returns its id."""
        middle = self.add_point(point)
        for f in list(self.around[u] & self.around[v]):
            face, label = self.faces[f], self.labels[f]
            self.remove_face(f)
            for end in (u, v):
                a, b, c = (middle if w == end else w for w in face)
                self.add_face((a, b, c), label)
        return middle

    def to_mesh(self) -> trimesh.Trimesh:
        """Returns the mesh, without vertices that no face uses."""
        mesh = trimesh.Trimesh(np.array(self.points), list(self.faces.values()), process=False)
        mesh.remove_unreferenced_vertices()
        return mesh
