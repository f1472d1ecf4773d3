"""New faces in a resting plane: small ones at its corners, a narrow rim, few within.

A corner of the support polygon is felt where the centroid of its face is (see `felt`), so sharp
corners get a small face of their own, an ear, and outlines a narrow rim where that is not enough.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon

Array = NDArray[np.float64]
Face = tuple[int, int, int]

_CONVEX = 1 - 1e-6
"""Share of its hull's area that a convex polygon fills."""
_OUTSIDE = 1e-6
"""Share of an ear's area that may lie outside: rounding."""
_DIGITS = 10
"""Decimals of m to which coordinates are the same point."""


@dataclass(frozen=True)
class Cap:
    """New faces of a plane: points (n, 2), those of the outline first, and faces over them."""

    points: Array
    faces: list[Face]

    def centroids(self) -> Array:
        """Returns the centroids of the faces, (f, 2)."""
        return np.asarray(self.points[np.array(self.faces)].mean(axis=1))

    def areas(self) -> Array:
        """Returns the areas of the faces, (f,), m^2."""
        a, b, c = np.moveaxis(self.points[np.array(self.faces)], 1, 0)
        u, v = b - a, c - a
        return np.asarray(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2)

    def closes(self, loops: Sequence[Sequence[int]]) -> bool:
        """Whether the faces fill their outline, and nothing else, each edge of it once.

        Args:
            loops: vertices of the outline in the order of `points`; one may be there twice.
        """
        n = len(self.points)
        names = [v + n for loop in loops for v in loop]
        names += range(len(names), n)
        corners = [[names[i] for i in face] for face in self.faces]
        edges = {edge for a, b, c in corners for edge in ((a, b), (b, c), (c, a))}
        outline = {
            (a + n, b + n)
            for loop in loops
            for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)
        }
        return len(edges) == 3 * len(corners) and outline == {
            (a, b) for a, b in edges if (b, a) not in edges
        }


def triangulate_cap(
    loops: Sequence[Array], ears: Iterable[tuple[int, int]], rim: float, coarse: float
) -> Cap:
    """Triangulates what loops enclose.

    Args:
        loops: (n, 2) polygons, m: anticlockwise around material, clockwise around holes.
        ears: corners (loop, index) that get a face of their own with their two neighbours, if
            there is room for it.
        rim: width of the rim, m; 0: none.
        coarse: corners of the rim's inside that are within this distance of a line without
            them are left out, m.

    Raises:
        GEOSException: the outline crosses itself.
    """
    points = np.concatenate(loops)
    starts = np.cumsum([0, *(len(loop) for loop in loops)])
    faces: list[Face] = []
    cut: dict[int, set[int]] = {}
    region = _region(loops)
    for k, i in ears:
        n, start = len(loops[k]), int(starts[k])
        ear = Polygon(loops[k][[(i - 1) % n, i, (i + 1) % n]])
        if ear.difference(region).area > _OUTSIDE * ear.area:
            continue  # a hole is in its way
        faces.append((start + (i - 1) % n, start + i, start + (i + 1) % n))
        cut.setdefault(k, set()).add(i)
    rest = [np.delete(loop, sorted(cut.get(k, ())), axis=0) for k, loop in enumerate(loops)]
    builder = _Builder(points, faces)
    for polygon in _polygons(rest):
        builder.fill(polygon, rim, coarse)
    return Cap(np.array(builder.points), builder.faces)


def grid_points(loops: Sequence[Array], spacing: float) -> Array:
    """Returns the middles (n, 2) of the cells of a square grid that lie in what loops enclose."""
    region = _region(loops)
    x0, y0, x1, y1 = region.bounds
    x, y = np.meshgrid(
        np.arange(x0 + spacing / 2, x1, spacing), np.arange(y0 + spacing / 2, y1, spacing)
    )
    inside = shapely.contains_xy(region, x, y)
    return np.column_stack([x[inside], y[inside]])


class _Builder:
    """Collects the faces of one plane; a point that was seen before keeps its number."""

    def __init__(self, points: Array, faces: list[Face]) -> None:
        self.points = [np.array(p) for p in points]
        self.faces = faces
        self._ids: dict[tuple[float, float], int] = {
            self._key(p): i for i, p in reversed(list(enumerate(points)))
        }

    def fill(self, polygon: Polygon, rim: float, coarse: float) -> None:
        inner = _inset(polygon, rim) if rim > 0 else polygon
        for part in _parts(inner) if rim > 0 else []:
            simple = _simplified(part, coarse)
            # What is left out must not let the inside touch or cross the outline.
            if simple.is_valid and polygon.contains(simple):
                inner = inner.difference(part).union(simple)
        if inner.is_empty or rim == 0:
            self._inside(polygon)
            return
        self._delaunay(polygon.difference(inner))
        for part in _parts(inner):
            self._inside(part)

    def _inside(self, polygon: Polygon) -> None:
        """Fills a polygon; a convex one with a fan, whose centroids lie far out."""
        if polygon.interiors or polygon.area < _CONVEX * polygon.convex_hull.area:
            self._delaunay(polygon)
            return
        ring = np.array(polygon.exterior.coords)[:-1]
        centre = self._id(np.array(polygon.centroid.coords[0]))
        corners = [self._id(p) for p in _anticlockwise(ring)]
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            self._add(a, b, centre)

    def _delaunay(self, region: shapely.Geometry) -> None:
        for polygon in _parts(region):
            for corners in _triangles(polygon):
                a, b, c = (self._id(p) for p in _anticlockwise(corners))
                self._add(a, b, c)

    def _add(self, a: int, b: int, c: int) -> None:
        if len({a, b, c}) == 3:
            self.faces.append((a, b, c))

    def _id(self, point: Array) -> int:
        key = self._key(point)
        if key not in self._ids:
            self._ids[key] = len(self.points)
            self.points.append(np.array(point))
        return self._ids[key]

    @staticmethod
    def _key(point: Array) -> tuple[float, float]:
        x, y = point.round(_DIGITS) + 0.0  # -0.0 and 0.0 are one
        return float(x), float(y)


def _inset(polygon: Polygon, rim: float) -> shapely.Geometry:
    """What is left inside a rim; holes need none where they are far enough from it."""
    outer = Polygon(polygon.exterior).buffer(-rim, join_style="mitre", mitre_limit=2.0)
    holes = [Polygon(hole) for hole in polygon.interiors]
    if all(outer.contains(hole.buffer(rim)) for hole in holes):
        return outer.difference(shapely.union_all(holes)) if holes else outer
    return polygon.buffer(-rim, join_style="mitre", mitre_limit=2.0)


def _triangles(polygon: Polygon) -> list[Array]:
    """Triangles (3, 2) that cover a polygon and have its corners alone."""
    found = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    return [np.array(triangle.exterior.coords)[:3] for triangle in found]


def _anticlockwise(ring: Array) -> Array:
    """Returns a ring (n, 2) in anticlockwise sense."""
    x, y = ring.T
    area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    return ring if area > 0 else ring[::-1]


def _simplified(part: Polygon, coarse: float) -> Polygon:
    """Leaves out corners of the outside, not of holes, which are the outline's own."""
    return Polygon(Polygon(part.exterior).simplify(coarse).exterior, part.interiors)


def _region(loops: Sequence[Array]) -> shapely.Geometry:
    return shapely.union_all([shapely.make_valid(polygon) for polygon in _polygons(loops)])


def _polygons(loops: Sequence[Array]) -> list[Polygon]:
    rings = [loop for loop in loops if len(loop) >= 3]
    outer = [Polygon(ring) for ring in rings if Polygon(ring).exterior.is_ccw]
    holes = [ring for ring in rings if not Polygon(ring).exterior.is_ccw]
    polygons = []
    for shell in outer:
        inside = [
            h for h in holes if shapely.contains_xy(shell, *h[0]) or shell.touches(Point(h[0]))
        ]
        polygons.append(Polygon(shell.exterior, inside))
    return polygons


def _parts(geometry: shapely.Geometry) -> list[Polygon]:
    return [part for part in shapely.get_parts(geometry) if isinstance(part, Polygon)]
