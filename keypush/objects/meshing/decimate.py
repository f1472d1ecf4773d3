"""Decimation by quadric error metrics that leaves resting faces and their outlines alone.

Source: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997. The
libraries that do it cannot hold vertices fixed, and do not promise that a closed mesh stays closed.
"""

import heapq

import numpy as np
from numpy.typing import NDArray

from keypush.objects.meshing.surface import Surface

Array = NDArray[np.float64]

_AREA_POWER = 0.25
"""Large faces count for more, as in the paper, but not in full: small parts would vanish first."""
_CLEARANCE = 3e-4
"""A vertex that moves stays this far above every resting plane, m, or as far as it was."""


class Decimator:
    """Collapses a surface's cheapest edges, between vertices that are in no resting plane."""

    def __init__(self, surface: Surface, planes: Array, touching: NDArray[np.bool_]) -> None:
        """Makes the decimator of a surface.

        Args:
            surface: mesh under edit.
            planes: its resting planes (k, 4): outward normal and offset.
            touching: for each vertex and plane whether it lies there, (n, k); these stay.
        """
        self._surface = surface
        self._planes = planes
        self._touching = touching
        self._fixed = touching.any(axis=1).tolist()
        self._quadrics = np.zeros((len(surface.points), 4, 4))
        for face in surface.faces.values():
            normal = surface.normals_area(face)
            area = float(np.linalg.norm(normal))
            if area > 0:
                n = normal / area
                plane = np.array([*n, -n @ surface.points[face[0]]])
                self._quadrics[list(face)] += area**_AREA_POWER * np.outer(plane, plane)
        self._versions = [0] * len(surface.points)
        self._heap: list[tuple[float, int, int, int, int]] = []
        for u, v in surface.edges():
            self._push(u, v)

    def reduce_to(self, count: int) -> None:
        """Collapses edges until at most `count` faces are free, or none can be collapsed."""
        surface = self._surface
        while self._heap and len(surface.faces) > count:
            _, u, v, version_u, version_v = heapq.heappop(self._heap)
            if (self._versions[u], self._versions[v]) != (version_u, version_v):
                continue
            if self._fixed[u]:
                u, v = v, u
            point, _ = self._target(u, v)
            if self._allowed(u, v, point) and surface.can_collapse(u, v, point):
                self._collapse(u, v, point)

    def _collapse(self, u: int, v: int, point: Array) -> None:
        self._surface.collapse(u, v, point)
        self._quadrics[v] += self._quadrics[u]
        self._versions[u] += 1
        self._versions[v] += 1
        for w in self._surface.neighbours(v):
            self._push(v, w)

    def _push(self, u: int, v: int) -> None:
        if self._fixed[u] and self._fixed[v]:
            return
        if self._fixed[u]:
            u, v = v, u
        _, cost = self._target(u, v)
        heapq.heappush(self._heap, (cost, u, v, self._versions[u], self._versions[v]))

    def _target(self, u: int, v: int) -> tuple[Array, float]:
        """Where u and v would become one (3,), and what that costs; v may be fixed."""
        quadric = self._quadrics[u] + self._quadrics[v]
        p, q = self._surface.points[u], self._surface.points[v]
        if self._fixed[v]:
            return q, _cost(quadric, q)
        candidates = [q, p, (p + q) / 2]
        best = _minimum(quadric, candidates[2])
        # An almost flat quadric has its minimum anywhere.
        if np.linalg.norm(best - candidates[2]) < 2 * np.linalg.norm(p - q):
            candidates.insert(0, best)
        costs = [_cost(quadric, candidate) for candidate in candidates]
        least = int(np.argmin(costs))
        return candidates[least], costs[least]

    def _allowed(self, u: int, v: int, point: Array) -> bool:
        if self._fixed[v]:
            return not self._lays_flat(u, v)
        points = np.array([point, self._surface.points[u], self._surface.points[v]])
        above = self._planes[:, 3] - points @ self._planes[:, :3].T
        return bool(np.all(above[0] >= np.minimum(_CLEARANCE, above[1:].min(axis=0))))

    def _lays_flat(self, u: int, v: int) -> bool:
        """Whether a face of u would lie in a resting plane if u went to v: walls must stand."""
        surface = self._surface
        for f in surface.around[u] - surface.around[v]:
            a, b = (w for w in surface.faces[f] if w != u)
            if np.any(self._touching[v] & self._touching[a] & self._touching[b]):
                return True
        return False


def _minimum(quadric: Array, start: Array) -> Array:
    """Where the quadric is least; where it is flat, as near to `start` as possible."""
    A, b = quadric[:3, :3], quadric[:3, 3]
    values, vectors = np.linalg.eigh(A)
    keep = values > 1e-3 * values[-1]
    if values[-1] <= 0:
        return start
    step = vectors[:, keep] @ ((vectors[:, keep].T @ (-b - A @ start)) / values[keep])
    return np.asarray(start + step)


def _cost(quadric: Array, p: Array) -> float:
    h = np.array([p[0], p[1], p[2], 1.0])
    return float(h @ quadric @ h)
