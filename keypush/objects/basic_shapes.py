"""The first eight shapes. Sizes are in m at scale 1; the catalogue then fits them to its sphere."""

import trimesh

from keypush.objects.shapes import add_handle, lathe, prism, straight_wall

SEGMENTS = 24
"""Corners of a round cross section."""
WIDE_SEGMENTS = 32
"""The same for wide ones: sides so short that faces at a corner reach to within 1 mm of it."""


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
    return lathe(straight_wall(0.0492 * scale, 0.0, 0.0177 * scale), WIDE_SEGMENTS)


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
    radius, wall = 0.030 * scale, 0.004 * scale
    rows = [0.0, 0.014, 0.024, 0.050, 0.058, 0.068]
    outside = [(radius, z * scale) for z in rows]
    inside = [(radius - wall, rows[-1] * scale), (radius - wall, wall)]
    mesh = lathe([*outside, *inside], SEGMENTS)
    # One loop, the inside of the rim, comes before row 0.
    lower, upper = (_quad(SEGMENTS * (1 + rows.index(z))) for z in (0.014, 0.050))
    return add_handle(mesh, lower, upper, 0.022 * scale)


def _quad(start: int) -> list[int]:
    return [start, start + 1, start + SEGMENTS + 1, start + SEGMENTS]


def _cuboid(length: float, width: float, height: float) -> trimesh.Trimesh:
    x, y = length / 2, width / 2
    return prism([(-x, -y), (x, -y), (x, y), (-x, y)], height)
