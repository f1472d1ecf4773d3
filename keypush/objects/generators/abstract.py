"""Abstract shapes: a candle, blocks, a ring, dishes and other things that are no household class.

All sizes are in m; every shape stands on z = 0 and fits a sphere of about 5 cm.
"""

import numpy as np
from manifold3d import CrossSection, JoinType, Manifold

from keypush.objects.generators.solids import (
    Array,
    box,
    cone,
    cylinder,
    lathe,
    rod,
    union,
)

_CORNER_SEGMENTS = 16
"""Corners of a full turn, of which a rounded corner of an outline takes its share."""
_SEAM = 4e-4
"""Movement (m) that is allowed to rid the seams of joined solids of slivers."""


def candle(
    *,
    radius: float = 0.0146,
    height: float = 0.086,
    taper: float = 0.12,
    wick_radius: float = 0.0025,
    wick_height: float = 0.010,
) -> Manifold:
    """Returns a slim candle with a molten hollow in its top and a wick.

    Args:
        radius: of the foot (m).
        height: of the wax, without the wick (m).
        taper: share of the radius that is lost from the foot to the top.
        wick_radius: half the thickness of the wick (m).
        wick_height: how far the wick stands out above the wax's edge (m).
    """
    top, tip = radius * (1 - taper), height + wick_height
    pool = height - 0.22 * radius
    edge = [(0.85 * top, height), (0.70 * top, height), (0.40 * top, pool), (0.0, pool)]
    wax = lathe([(0.0, 0.0), (radius, 0.0), (top, height - 0.15 * radius), *edge])
    start, shoulder = (0.0, 0.0, height / 2), (0.0, 0.0, tip - wick_radius)
    wick = cylinder(start, shoulder, wick_radius, 8)
    return wax + wick + cone(shoulder, (0.0, 0.0, tip), wick_radius, 0.6 * wick_radius, 8)


def bumpy_toy(
    *,
    body_radius: float = 0.0385,
    bump_radius: float = 0.014,
    sinking: float = 0.005,
    base_height: float = 0.0265,
) -> Manifold:
    """Returns a ball with eight large round bumps and a flat base.

    Args:
        body_radius: of the ball (m).
        bump_radius: of a bump (m).
        sinking: how far below the ball's surface the middle of a bump lies (m).
        base_height: of the ball's middle above the flat base (m).
    """
    rim, dome = _bump(body_radius, bump_radius, body_radius - sinking)
    base_radius = np.sqrt(body_radius**2 - base_height**2)
    corners = [_circle(base_radius, -base_height, 10)]
    domes = []
    # Five bumps around the ball, and three above, turned so that they stand over gaps.
    around = [(72.0 * i, 8.0) for i in range(5)]
    above = [(120.0 * i + 42.0, 54.0) for i in range(3)]
    for azimuth_deg, elevation_deg in around + above:
        turn = _outwards(azimuth_deg, elevation_deg)
        corners.append(rim @ turn.T)
        domes.append(Manifold.hull_points(dome @ turn.T))
    # The ball has corners on the bumps' rims: so it meets them without slivers.
    body = Manifold.hull_points(np.vstack(corners))
    return union([body, *domes]).translate((0.0, 0.0, base_height))


def l_block(
    *,
    length: float = 0.078,
    foot: float = 0.054,
    width: float = 0.024,
    height: float = 0.028,
) -> Manifold:
    """Returns an upright prism over the letter L.

    Args:
        length: of the long arm (m).
        foot: length of the short arm (m).
        width: of both arms (m).
        height: of the block (m).
    """
    stem = CrossSection.square((width, length))
    return Manifold.extrude(_blunt(stem + CrossSection.square((foot, width))), height)


def t_block(
    *,
    bar: float = 0.074,
    length: float = 0.062,
    width: float = 0.022,
    height: float = 0.028,
) -> Manifold:
    """Returns an upright prism over the letter T.

    Args:
        bar: length of the cross bar (m).
        length: of the whole letter along its stem (m).
        width: of bar and stem (m).
        height: of the block (m).
    """
    stem = CrossSection.square((width, length)).translate((-width / 2, 0.0))
    top = CrossSection.square((bar, width)).translate((-bar / 2, length - width))
    return Manifold.extrude(_blunt(stem + top), height)


def ring(
    *,
    radius: float = 0.0365,
    tube_radius: float = 0.0130,
    flattening: float = 0.0025,
) -> Manifold:
    """Returns a torus that lies flat on a flattened underside.

    Args:
        radius: from the middle to the middle of the tube (m).
        tube_radius: of the tube's cross section (m).
        flattening: what the tube lacks below (m).
    """
    axis_height = tube_radius - flattening
    edge = np.arccos(axis_height / tube_radius)
    angles = np.linspace(edge, 2 * np.pi - edge, 8) - np.pi / 2
    section = np.column_stack(
        [radius + tube_radius * np.cos(angles), axis_height + tube_radius * np.sin(angles)]
    )
    # The flat side's corners would be at z = 0 only up to rounding.
    section[[0, -1], 1] = 0.0
    return Manifold.revolve(CrossSection([section]), 18)


def star_prism(
    *,
    points: int = 5,
    outer_radius: float = 0.0488,
    inner_radius: float = 0.0235,
    height: float = 0.030,
) -> Manifold:
    """Returns an upright prism over a star with blunt tips.

    Args:
        points: number of tips.
        outer_radius: to the tips before they are blunted (m).
        inner_radius: to the corners between the tips (m).
        height: of the prism (m).
    """
    angles = np.pi * np.arange(2 * points) / points
    radii = np.where(np.arange(2 * points) % 2 == 0, outer_radius, inner_radius)
    star = CrossSection([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])
    return Manifold.extrude(_blunt(star, 0.003), height)


def plate(
    *,
    radius: float = 0.0490,
    height: float = 0.021,
    foot_radius: float = 0.028,
    thickness: float = 0.0045,
) -> Manifold:
    """Returns a flat round dish with a raised rim on a foot.

    Args:
        radius: to the edge of the rim (m).
        height: of the rim (m).
        foot_radius: of the flat foot (m).
        thickness: of the wall (m).
    """
    foot_height = 0.18 * height
    bottom = 0.75 * radius
    floor = foot_height + thickness
    return lathe(
        [
            (0.0, 0.0),
            (foot_radius, 0.0),
            (foot_radius, foot_height),
            (bottom, foot_height + 0.001),
            (radius, height - 0.6 * thickness),
            (radius - 0.25 * thickness, height),
            (radius - thickness, height),
            (bottom - 0.9 * thickness, floor + 0.001),
            (0.6 * bottom, floor),
            (0.0, floor),
        ],
    )


def tripod(
    *,
    spread: float = 0.031,
    foot_radius: float = 0.0085,
    leg_radius: float = 0.0052,
    hub_radius: float = 0.0135,
    post_radius: float = 0.0075,
    height: float = 0.054,
) -> Manifold:
    """Returns a hub with a short post on three splayed legs with flat feet.

    Args:
        spread: from the middle to the middle of a foot (m).
        foot_radius: of a foot (m).
        leg_radius: half the thickness of a leg (m).
        hub_radius: of the hub that the legs come from (m).
        post_radius: of the post on the hub (m).
        height: to the top of the post (m).
    """
    # The hub hangs low, so that a finger that slips between two legs still meets it.
    hub_bottom, hub_top = 0.2 * height, 0.52 * height
    hub = cone((0.0, 0.0, hub_bottom), (0.0, 0.0, hub_top), hub_radius, 0.8 * hub_radius, 18)
    post = cylinder((0.0, 0.0, hub_bottom), (0.0, 0.0, height), post_radius, 16)
    shoulder = (0.6 * hub_radius, 0.0, hub_top - leg_radius)
    ankle = (spread, 0.0, 1.1 * leg_radius)
    foot = cone((spread, 0.0, 0.0), (spread, 0.0, leg_radius), foot_radius, 0.9 * foot_radius, 16)
    leg = rod(shoulder, ankle, leg_radius, segments=10) + foot
    legs = [leg.rotate((0.0, 0.0, azimuth_deg)) for azimuth_deg in (90.0, 210.0, 330.0)]
    return union([hub, post, *legs]).simplify(_SEAM)


def open_box(
    *,
    length: float = 0.068,
    width: float = 0.052,
    height: float = 0.050,
    wall: float = 0.003,
) -> Manifold:
    """Returns a box without a lid.

    Args:
        length: outside, along x (m).
        width: outside, along y (m).
        height: outside (m).
        wall: thickness of the walls and of the floor (m).
    """
    inside = box((length - 2 * wall, width - 2 * wall, height), (0.0, 0.0, wall))
    return box((length, width, height)) - inside


def twisted_prism(
    *,
    radius: float = 0.0355,
    height: float = 0.062,
    twist_deg: float = 40.0,
    top_scale: float = 0.62,
    offset: float = 0.010,
) -> Manifold:
    """Returns a lopsided pentagon that turns and narrows from its base to its top.

    Args:
        radius: of the base, about (m).
        height: of the prism (m).
        twist_deg: turn of the top against the base (deg).
        top_scale: size of the top relative to the base.
        offset: of the pentagon's middle from the axis of the twist (m).
    """
    angles = 2 * np.pi * np.arange(5) / 5
    radii = radius * np.array([1.0, 0.84, 1.08, 0.90, 0.80])
    outline: Array = np.column_stack([offset + radii * np.cos(angles), radii * np.sin(angles)])
    return Manifold.extrude(CrossSection([outline]), height, 9, twist_deg, (top_scale, top_scale))


def _blunt(outline: CrossSection, radius: float = 0.002) -> CrossSection:
    """Rounds the outward corners of an outline, which a finger would otherwise meet as edges."""
    return (
        outline.offset(-radius, JoinType.Miter)
        .offset(radius, JoinType.Round, circular_segments=_CORNER_SEGMENTS)
        .simplify(2e-4)
    )


def _bump(body_radius: float, radius: float, distance: float) -> tuple[Array, Array]:
    """Returns the corners of a bump about +z on a ball about the origin.

    Args:
        body_radius: of the ball (m).
        radius: of the bump (m).
        distance: of the bump's middle from the ball's (m).

    Returns:
        The rim where the two spheres meet, and all corners, with one inside the ball.
    """
    corners = 7
    rim_height = (body_radius**2 + distance**2 - radius**2) / (2 * distance)
    rim = _circle(np.sqrt(body_radius**2 - rim_height**2), rim_height, corners)
    # Every other ring is turned by half a side, which looks rounder for as many faces.
    rings = [
        _circle(radius * np.sin(polar), distance + radius * np.cos(polar), corners, turn)
        for polar, turn in ((np.deg2rad(54.0), 0.5), (np.deg2rad(18.0), 0.0))
    ]
    return rim, np.vstack([rim, *rings, [[0.0, 0.0, distance - radius]]])


def _circle(radius: float, height: float, corners: int, turn: float = 0.0) -> Array:
    """Returns evenly spaced points (corners, 3) on a circle, turned by a share of a side."""
    angles = 2 * np.pi * (np.arange(corners) + turn) / corners
    return np.column_stack(
        [radius * np.cos(angles), radius * np.sin(angles), np.full(corners, height)]
    )


def _outwards(azimuth_deg: float, elevation_deg: float) -> Array:
    """Returns the rotation (3, 3) that takes +z to a direction."""
    azimuth, elevation = np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg)
    c, s = np.cos(azimuth), np.sin(azimuth)
    u, v = np.sin(elevation), np.cos(elevation)
    return np.array([[c * u, -s, c * v], [s * u, c, s * v], [-v, 0.0, u]])
