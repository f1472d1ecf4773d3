"""Building blocks of the generators: manifold3d solids, which booleans keep closed.

All sizes are in m. `+` joins two solids, `-` cuts, `^` intersects (manifold3d's operators).
"""

from collections.abc import Sequence

import numpy as np
from manifold3d import CrossSection, Manifold, Mesh64, OpType
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float, float, float]

SEGMENTS = 24
"""Corners of a round cross section: at 3 cm its sides are 0.26 mm inside the circle."""


def box(size: Point, centre: Point = (0.0, 0.0, 0.0)) -> Manifold:
    """Returns a box that stands with the middle of its base at `centre`."""
    return Manifold.cube(size, center=True).translate(
        (centre[0], centre[1], centre[2] + size[2] / 2)
    )


def rounded_box(size: Point, radius: float, centre: Point = (0.0, 0.0, 0.0)) -> Manifold:
    """Returns a box like `box` whose vertical edges are rounded."""
    x, y, z = size
    section = CrossSection.square((x - 2 * radius, y - 2 * radius), center=True).offset(
        radius, circular_segments=12
    )
    return Manifold.extrude(section, z).translate(centre)


def prism(outline: Sequence[tuple[float, float]] | Array, height: float) -> Manifold:
    """Returns an upright prism over an anticlockwise outline, from z = 0."""
    return Manifold.extrude(CrossSection([np.asarray(outline, dtype=float)]), height)


def lathe(profile: Sequence[tuple[float, float]] | Array, segments: int = SEGMENTS) -> Manifold:
    """Returns the solid of revolution about z of a closed outline of (radius, height)."""
    return Manifold.revolve(CrossSection([np.asarray(profile, dtype=float)]), segments)


def ellipsoid(radii: Point, centre: Point, segments: int = SEGMENTS) -> Manifold:
    """Returns an ellipsoid with axes along x, y, z."""
    return Manifold.sphere(1.0, segments).scale(radii).translate(centre)


def rod(start: Point, end: Point, radius: float, segments: int = 12) -> Manifold:
    """Returns a cylinder between two points, with round ends."""
    ball = Manifold.sphere(radius, segments)
    return Manifold.batch_hull([ball.translate(start), ball.translate(end)])


def above_ground(solid: Manifold, height: float = 0.0) -> Manifold:
    """Cuts off what lies below z = `height`, which leaves a flat base there."""
    return solid.trim_by_plane((0.0, 0.0, 1.0), height)


def union(parts: Sequence[Manifold]) -> Manifold:
    """Joins solids into one."""
    return Manifold.batch_boolean(list(parts), OpType.Add)


def soft_box(
    size: Point, radius: float, centre: Point = (0.0, 0.0, 0.0), segments: int = 12
) -> Manifold:
    """Returns a box like `box` whose edges and corners are all rounded."""
    x, y, z = (side / 2 - radius for side in size)
    ball = Manifold.sphere(radius, segments)
    corners = [
        ball.translate((i * x, j * y, k * z)) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)
    ]
    return Manifold.batch_hull(corners).translate((centre[0], centre[1], centre[2] + size[2] / 2))


def cone(
    start: Point, end: Point, radius: float, end_radius: float, segments: int = SEGMENTS
) -> Manifold:
    """Returns a truncated cone between the middles of its two flat ends."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(b - a))
    axis = (b - a) / length
    side = np.cross(axis, (1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 1.0, 0.0))
    side /= np.linalg.norm(side)
    pose = np.column_stack([side, np.cross(axis, side), axis, a])
    return Manifold.cylinder(length, radius, end_radius, segments).transform(pose)


def cylinder(start: Point, end: Point, radius: float, segments: int = SEGMENTS) -> Manifold:
    """Returns a cylinder between the middles of its two flat ends."""
    return cone(start, end, radius, radius, segments)


def side_plate(outline: Sequence[tuple[float, float]] | Array, width: float) -> Manifold:
    """Returns a plate over an anticlockwise outline of (x, z), `width` wide about y = 0."""
    return prism(outline, width).rotate((90.0, 0.0, 0.0)).translate((0.0, width / 2, 0.0))


def curve(points: Sequence[Sequence[float]], steps: int) -> list[list[float]]:
    """Returns a smooth curve (Catmull-Rom) through points, `steps` pieces from each to the next."""
    p = np.asarray(points, dtype=float)
    p = np.vstack([2 * p[0] - p[1], p, 2 * p[-1] - p[-2]])
    t = (np.arange(steps) / steps)[:, None]
    pieces = [
        b
        + 0.5 * t * (c - a)
        + t**2 * (a - 2.5 * b + 2 * c - 0.5 * d)
        + t**3 * (1.5 * (b - c) + 0.5 * (d - a))
        for a, b, c, d in zip(p[:-3], p[1:-2], p[2:-1], p[3:], strict=True)
    ]
    return [*np.vstack(pieces).tolist(), p[-2].tolist()]


def sweep(
    path: Sequence[Sequence[float]] | Array, radii: float | Array, segments: int = 12
) -> Manifold:
    """Returns a round bar along a smooth path: one ring of corners at each of its points.

    Args:
        path: points; bends have to be wider than the bar.
        radii: one radius, or one for each point.
        segments: corners of the cross section.
    """
    p = np.asarray(path, dtype=float)
    tangents = np.gradient(p, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    side = np.eye(3)[np.abs(tangents[0]).argmin()]
    angles = 2 * np.pi * np.arange(segments)[:, None] / segments
    rings = []
    for point, tangent, radius in zip(p, tangents, np.broadcast_to(radii, len(p)), strict=True):
        side = side - (side @ tangent) * tangent
        side = side / np.linalg.norm(side)
        across = np.cos(angles) * side + np.sin(angles) * np.cross(tangent, side)
        rings.append(point + radius * across)
    faces = []
    for a in range((len(p) - 1) * segments):
        b = a - a % segments + (a + 1) % segments
        faces += [(a, b, b + segments), (a, b + segments, a + segments)]
    first, last = len(p) * segments, len(p) * segments + 1
    for a in range(segments):
        b = (a + 1) % segments
        faces += [(b, a, first), (first - segments + a, first - segments + b, last)]
    corners = np.vstack([*rings, p[0], p[-1]])
    return Manifold(Mesh64(corners, np.array(faces, dtype=np.uint64)))
