"""The first eight shapes. Sizes are in m at scale 1; the catalogue then fits them to its sphere."""

import trimesh

from keypush.objects.shapes import add_handle, lathe, prism, straight_wall

SEGMENTS = 20
"""Corners of a round cross section."""


def box(scale: float) -> trimesh.Trimesh:
    """A box of 10 x 8 x 6 parts."""
    return _cuboid(0.0707 * scale, 0.0566 * scale, 0.0424 * scale)


def tall_box(scale: float) -> trimesh.Trimesh:
    """A box of 5 x 5 x 10 parts."""
    return _cuboid(0.0408 * scale, 0.0408 * scale, 0.0816 * scale)


def can(scale: float) -> trimesh.Trimesh:
    """A cylinder, 7 parts wide and 10 high."""
    return lathe(straight_wall(0.0287 * scale, 0.0, 0.0819 * scale), SEGMENTS)


def candle(scale: float) -> trimesh.Trimesh:
    """A thin cylinder, 3 parts wide and 10 high."""
    return lathe(straight_wall(0.0144 * scale, 0.0, 0.0958 * scale), SEGMENTS)


def disc(scale: float) -> trimesh.Trimesh:
    """A flat cylinder, 10 parts wide and 1.8 high."""
    return lathe(straight_wall(0.0492 * scale, 0.0, 0.0177 * scale), SEGMENTS)


def bottle(scale: float) -> trimesh.Trimesh:
    """A bottle: straight body, shoulder, neck."""
    body = straight_wall(0.0195 * scale, 0.0, 0.055 * scale)
    return lathe([*body, (0.009 * scale, 0.075 * scale), (0.009 * scale, 0.098 * scale)], SEGMENTS)


def l_block(scale: float) -> trimesh.Trimesh:
    """A block with an L as its footprint."""
    near, far = -0.0125 * scale, 0.0475 * scale
    corners = [(near, near), (far, near), (far, -near), (-near, -near), (-near, far), (near, far)]
    return prism(corners, 0.035 * scale)


def mug(scale: float) -> trimesh.Trimesh:
    """A hollow mug with a handle towards +x."""
    radius, height, wall = 0.030 * scale, 0.068 * scale, 0.004 * scale
    rows = [0.0, 0.006 * scale, 0.014 * scale, 0.024 * scale, 0.050 * scale, 0.058 * scale, height]
    outside = [(radius, z) for z in rows]
    inside = [(radius - wall, height), (radius - wall, wall)]
    mesh = lathe([*outside, *inside], SEGMENTS)
    # base_rings puts the base's outline, row 0 of the wall, in the loop before the second row.
    first = len(mesh.vertices) - 2 - SEGMENTS * (len(rows) + len(inside))
    lower, upper = (_quad(first + SEGMENTS * rows.index(z * scale)) for z in (0.014, 0.050))
    return add_handle(mesh, lower, upper, 0.022 * scale)


def _quad(start: int) -> list[int]:
    return [start, start + 1, start + SEGMENTS + 1, start + SEGMENTS]


def _cuboid(length: float, width: float, height: float) -> trimesh.Trimesh:
    x, y = length / 2, width / 2
    return prism([(-x, -y), (x, -y), (x, y), (-x, y)], height)
