"""Hollow things and things to drink from: bottle, mug, glass, bowl, can.

All are solids of revolution about z, apart from the mug's handle and the can's tab.
"""

from collections.abc import Sequence

import numpy as np
from manifold3d import Manifold

from keypush.objects.generators.solids import (
    SEGMENTS,
    curve,
    cylinder,
    lathe,
    rounded_box,
    sweep,
)

Profile = Sequence[Sequence[float]]


def bottle(
    *,
    height: float = 0.095,
    radius: float = 0.019,
    neck_radius: float = 0.0075,
    neck_length: float = 0.020,
    shoulder: float = 0.026,
    wall: float = 0.0035,
) -> Manifold:
    """Builds an open bottle with a lip around its mouth.

    Args:
        height: of the whole (m).
        radius: of the body, outside (m).
        neck_radius: of the neck, outside (m).
        neck_length: from the mouth down to the shoulder (m).
        shoulder: height of the slope between neck and body (m).
        wall: thickness of the wall (m).
    """
    neck = height - neck_length
    body = neck - shoulder
    slope = _ease(radius, body, neck_radius, neck)
    lip = neck_radius + 0.0022
    outer = [
        (radius - 0.002, 0.0),
        (radius, 0.002),
        *slope,
        (neck_radius, height - 0.008),
        (lip, height - 0.007),
        (lip, height),
    ]
    inside = _ease(radius - wall, body, neck_radius - wall, neck)
    inner = [(radius - wall, 2 * wall), *inside, (neck_radius - wall, height)]
    return _revolved(outer, inner, 18)


def mug(
    *,
    height: float = 0.070,
    radius: float = 0.030,
    base_radius: float = 0.030,
    handle_width: float = 0.024,
    handle_height: float = 0.044,
    handle_thickness: float = 0.008,
    squareness: float = 0.6,
    wall: float = 0.0035,
) -> Manifold:
    """Builds a mug with a handle on the side of +x.

    Args:
        height: of the cup (m).
        radius: of the rim, outside (m).
        base_radius: of the base, outside (m).
        handle_width: how far the handle's middle line stands out from the wall (m).
        handle_height: of the handle's middle line (m).
        handle_thickness: across the handle (m).
        squareness: shape of the handle, from 0, a half ellipse, to 1, nearly a rectangle.
        wall: thickness of the wall (m).
    """
    bevel = 0.002
    outer = [(base_radius - bevel, 0.0), (base_radius, bevel), (radius, height)]
    inner = [(base_radius - wall - bevel, wall + 0.001), (base_radius - wall, wall + 0.003)]
    cup = _revolved(outer, [], SEGMENTS)
    room = _revolved([*inner, (radius - wall, height + 0.001)], [], SEGMENTS)
    turn = np.linspace(-np.pi / 2, np.pi / 2, 9)
    power = 1.0 - 0.5 * squareness
    x = np.cos(turn) ** power
    z = np.sign(turn) * np.abs(np.sin(turn)) ** power
    heights = 0.52 * height + handle_height / 2 * z
    wall_x = base_radius + (radius - base_radius) * heights / height - wall / 2
    path = np.column_stack([wall_x + handle_width * x, np.zeros_like(x), heights])
    return cup + sweep(path, handle_thickness / 2) - room


def glass(
    *,
    height: float = 0.090,
    rim_radius: float = 0.026,
    belly_radius: float = 0.028,
    waist_radius: float = 0.012,
    foot_radius: float = 0.024,
    foot_height: float = 0.022,
    wall: float = 0.0033,
) -> Manifold:
    """Builds a drinking glass whose bowl stands on a short solid foot.

    Args:
        height: of the whole (m).
        rim_radius: of the rim, outside (m).
        belly_radius: of the bowl where it is widest, outside (m).
        waist_radius: of the narrowest place, between foot and bowl (m).
        foot_radius: of the base (m).
        foot_height: from the ground to the narrowest place (m).
        wall: thickness of the wall (m).
    """
    belly_z = foot_height + 0.42 * (height - foot_height)
    start, low = (waist_radius, foot_height), (0.82 * belly_radius, foot_height + 0.012)
    bowl_outside = curve([start, low, (belly_radius, belly_z), (rim_radius, height)], 3)
    foot = [
        (foot_radius, 0.0),
        (foot_radius, 0.006),
        (0.55 * foot_radius + 0.45 * waist_radius, 0.011),
    ]
    floor = foot_height + wall + 0.001
    inner = [
        (0.45 * belly_radius, floor),
        *((r - wall, z) for r, z in bowl_outside if z > floor + 0.004),
    ]
    return _revolved([*foot, *bowl_outside], inner, 20)


def bowl(
    *,
    height: float = 0.042,
    radius: float = 0.045,
    foot_radius: float = 0.023,
    foot_height: float = 0.006,
    wall: float = 0.0038,
) -> Manifold:
    """Builds a bowl on a foot ring.

    Args:
        height: of the whole (m).
        radius: of the rim, outside (m).
        foot_radius: of the ring it stands on, outside (m).
        foot_height: of that ring (m).
        wall: thickness of the wall (m).
    """
    angles = np.linspace(0.5, np.pi / 2, 5)
    depth = height - foot_height + 0.003
    outside = [(radius * np.sin(a), height - depth * np.cos(a)) for a in angles]
    outside = [point for point in outside if point[0] > foot_radius]
    inner = [
        ((radius - wall) * np.sin(a), height - (depth - wall) * np.cos(a))
        for a in np.linspace(0.35, np.pi / 2, 5)
    ]
    ring = [
        (foot_radius - 0.005, 0.0),
        (foot_radius, 0.0),
        (foot_radius - 0.001, foot_height),
    ]
    hollow = [(0.0, 0.003), (foot_radius - 0.007, 0.003)]
    profile = [*hollow, *ring, *outside, *reversed(inner), (0.0, inner[0][1])]
    return lathe(profile, 22)


def can(
    *,
    height: float = 0.084,
    radius: float = 0.028,
    end_radius: float = 0.0235,
    taper: float = 0.009,
    recess: float = 0.003,
    tab_length: float = 0.020,
) -> Manifold:
    """Builds a closed can: rims at both ends, a lid set into the upper one, a tab to pull.

    Args:
        height: of the whole (m).
        radius: of the body (m).
        end_radius: of the rims (m).
        taper: height over which the body narrows to the rims (m).
        recess: how far the lid lies below the rim (m).
        tab_length: of the tab on the lid (m).
    """
    rim = 0.0035
    outer = [
        (end_radius, 0.0),
        (end_radius, rim),
        (radius, rim + taper),
        (radius, height - rim - taper),
        (end_radius - 0.0015, height - rim),
        (end_radius, height - rim),
        (end_radius, height),
    ]
    lid = height - recess
    inside = end_radius - 0.0032
    body = _revolved(outer, [(inside - 0.001, lid), (inside, height)], 24)
    tab = rounded_box((tab_length, 0.6 * tab_length, recess), 0.25 * tab_length, (0.0, 0.0, lid))
    rivet = (-0.25 * tab_length, 0.0)
    hole = cylinder((*rivet, lid + 0.001), (*rivet, height + 0.001), 0.12 * tab_length, 8)
    return body + tab.translate((0.2 * tab_length, 0.0, -0.001)) - hole


def _revolved(outer: Profile, inner: Profile, segments: int) -> Manifold:
    """Revolves a wall: its outside and its inside, each from the bottom up, as (radius, height)."""
    top = outer[-1][1]
    floor = inner[0][1] if inner else top
    outline = [(0.0, outer[0][1]), *outer, *reversed(inner), (0.0, floor)]
    return lathe([(float(r), float(z)) for r, z in outline], segments)


def _ease(
    radius: float, low: float, end_radius: float, high: float, steps: int = 5
) -> list[tuple[float, float]]:
    """Returns a smooth slope (half a cosine) from one radius and height to another."""
    part = np.linspace(0.0, 1.0, steps + 1)
    blend = (1 - np.cos(np.pi * part)) / 2
    radii = radius + (end_radius - radius) * blend
    return [(float(r), float(z)) for r, z in zip(radii, low + (high - low) * part, strict=True)]
