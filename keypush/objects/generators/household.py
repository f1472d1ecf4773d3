"""Plain things of the household: block, book, lamp base."""

import numpy as np
from manifold3d import Manifold

from keypush.objects.generators.solids import (
    Array,
    box,
    curve,
    cylinder,
    lathe,
    rounded_box,
    side_plate,
    soft_box,
    union,
)

_BULGE = 0.006
"""How far the spine of a book is rounded, m."""


def block(
    *,
    length: float = 0.080,
    width: float = 0.046,
    height: float = 0.038,
    rounding: float = 0.0025,
) -> Manifold:
    """Builds a rectangular block with rounded edges.

    Args:
        length: along x (m).
        width: along y (m).
        height: along z (m).
        rounding: radius of edges and corners (m).
    """
    return soft_box((length, width, height), rounding, segments=24)


def book(
    *,
    width: float = 0.056,
    length: float = 0.076,
    thickness: float = 0.028,
    cover: float = 0.0035,
    overhang: float = 0.003,
    band: float = 0.0015,
) -> Manifold:
    """Builds a thick closed book that lies on its back cover, its spine towards -x.

    Args:
        width: from spine to fore edge (m).
        length: along the spine (m).
        thickness: with both covers (m).
        cover: thickness of a cover (m).
        overhang: how far the covers stand out over the pages (m).
        band: how far the three bands stand out on the spine (m).
    """
    x, top = width / 2, thickness
    paper = top - 2 * cover
    corners = rounded_box((2 * width, length, top), 0.004, (-x, 0.0, 0.0))
    binding = side_plate(_binding(x, top), length) ^ corners
    raised = _spine(x, top, band)
    bands = [
        side_plate(raised, 0.006).translate((0.0, part * length, 0.0))
        for part in (-0.28, 0.0, 0.28)
    ]
    inside = box((2 * width, 2 * length, paper), (width - x + _BULGE, 0.0, cover))
    edge, back = x - overhang, -x + 0.004
    turn = np.linspace(-np.pi / 2, np.pi / 2, 7)
    fore = np.column_stack([edge - 0.003 * np.cos(turn), top / 2 + paper / 2 * np.sin(turn)])
    low, high = cover - 0.0005, top - cover + 0.0005
    outline = np.vstack([(back, low), (edge, low), fore, (edge, high), (back, high)])
    pages = side_plate(outline, length - 2 * overhang)
    return union([binding - inside, pages, *bands])


def lamp_base(
    *,
    height: float = 0.098,
    foot_radius: float = 0.025,
    foot_height: float = 0.018,
    belly_radius: float = 0.011,
    neck_radius: float = 0.005,
    socket_radius: float = 0.009,
    bulb_radius: float = 0.0145,
) -> Manifold:
    """Builds a table lamp without its shade: round foot, turned stem, socket, switch, bulb.

    Args:
        height: of the whole (m).
        foot_radius: of the foot (m).
        foot_height: of the foot (m).
        belly_radius: of the stem where it is thickest (m).
        neck_radius: of the stem's thin places (m).
        socket_radius: of the socket (m).
        bulb_radius: of the bulb (m).
    """
    centre = height - bulb_radius
    collar = centre - 1.5 * bulb_radius
    socket = collar - 0.010
    foot = [(foot_radius, 0.0), (foot_radius, foot_height - 0.004)]
    shoulder = [(0.86 * foot_radius, foot_height - 0.0005), (0.5 * foot_radius, foot_height)]
    throat = (1.1 * neck_radius, foot_height + 0.005)
    belly = (belly_radius, foot_height + 0.55 * (socket - foot_height))
    stem = curve([shoulder[-1], throat, belly, (neck_radius, socket)], 3)
    cup = [(socket_radius, socket + 0.002), (socket_radius, collar), (0.75 * socket_radius, collar)]
    angles = np.linspace(-0.45, np.pi / 2, 6)[:-1]
    bulb = bulb_radius * np.column_stack([np.cos(angles), np.sin(angles)]) + (0.0, centre)
    pear = [(0.68 * bulb_radius, centre - 0.85 * bulb_radius), *bulb, (0.0, height)]
    turned = lathe(np.vstack([(0.0, 0.0), foot, shoulder[:1], stem, cup, pear]), 20)
    z = (socket + collar) / 2
    stalk = cylinder((0.0, 0.0, z), (socket_radius + 0.005, 0.0, z), 0.0022, 8)
    knob = cylinder((socket_radius + 0.003, 0.0, z), (socket_radius + 0.008, 0.0, z), 0.004, 10)
    return turned + stalk + knob


def _spine(x: float, top: float, band: float = 0.0) -> Array:
    """The back of a book from above to below: a flat arch that stands out by `band` more."""
    turn = np.linspace(0.0, np.pi, 11)
    height = top / 2 + (top / 2 - 0.0007) * np.cos(turn)
    return np.column_stack([-x + _BULGE - (_BULGE + band) * np.sin(turn), height])


def _binding(x: float, top: float) -> Array:
    """Outline of spine and covers, with the groove along which a cover bends."""
    groove = [(-x + _BULGE + 0.003, 0.0018), (-x + _BULGE + 0.006, 0.0)]
    upper = [(a, top - d) for a, d in reversed(groove)]
    return np.vstack([_spine(x, top), groove, (x, 0.0), (x, top), upper])
