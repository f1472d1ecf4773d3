"""A low shoe, built from cross sections along its length."""

from itertools import pairwise

import numpy as np
from manifold3d import CrossSection, Manifold

from keypush.objects.generators.solids import Array, box, rod, union

_STATIONS = (
    # x, y of the middle line, half width and height of the upper, as fractions of length, width
    # and ankle height; from heel to toe.
    (-0.46, 0.00, 0.52, 0.96),
    (-0.40, 0.00, 0.76, 1.00),
    (-0.22, 0.00, 0.84, 0.94),
    (-0.02, 0.02, 0.84, 0.86),
    (0.10, 0.03, 0.92, 0.66),
    (0.24, 0.02, 0.96, 0.46),
    (0.36, 0.00, 0.84, 0.37),
    (0.44, -0.02, 0.58, 0.30),
    (0.475, -0.03, 0.34, 0.22),
)


def shoe(
    *,
    length: float = 0.092,
    width: float = 0.034,
    ankle_height: float = 0.040,
    sole: float = 0.008,
    wall: float = 0.0035,
) -> Manifold:
    """Builds a low shoe, its toe towards +x.

    Args:
        length: of the sole (m).
        width: of the sole at its widest (m).
        ankle_height: of the opening's edge at the heel (m).
        sole: thickness of the sole (m).
        wall: thickness of the upper (m).
    """
    upper = _upper(length, width, ankle_height, sole - 0.001, 0.0)
    room = _upper(length, width, ankle_height + 0.030, sole + 0.001, wall)
    back = box((0.60 * length, width, 0.1), (-0.36 * length, 0.0, 0.0))
    throat = back.translate((0.0, 0.0, sole + 0.001))
    foot = Manifold.extrude(_sole_outline(length, width), sole)
    arch = box((0.22 * length, 2 * width, 0.003), (-0.07 * length, 0.0, 0.0))
    low, high = (0.10 * length, 0.62 * ankle_height), (-0.07 * length, 1.05 * ankle_height)
    tongue = Manifold.batch_hull(
        [
            rod((x, -half * width, z), (x, half * width, z), 0.0019, 8)
            for (x, z), half in ((low, 0.16), (high, 0.22))
        ]
    )
    return foot - arch + (upper - (room ^ throat)) + tongue


def _upper(length: float, width: float, height: float, floor: float, inset: float) -> Manifold:
    """Hulls of neighbouring arches, from heel to toe, that stand on z = `floor`.

    Args:
        length: of the sole.
        width: of the sole.
        height: of the ankle over the ground.
        floor: height of the arches' feet over the ground.
        inset: what the arches are smaller by, at the sides and at the ends.
    """
    angles = np.linspace(0.0, np.pi, 11)
    arches = []
    for x, middle, half, top in _STATIONS:
        wide = 0.94 * half * width / 2 - inset
        across = middle * width + wide * _flattened(np.cos(angles))
        up = floor + (top * height - floor) * _flattened(np.sin(angles))
        along = np.full_like(up, x * length * (1 - 2 * inset / length))
        arches.append(np.column_stack([along, across, up]))
    return union([Manifold.hull_points(np.vstack(pair)) for pair in pairwise(arches)])


def _flattened(values: Array) -> Array:
    """Makes a half circle squarer: its sides steeper, its top flatter."""
    return np.asarray(np.sign(values) * np.abs(values) ** 0.75)


def _sole_outline(length: float, width: float) -> CrossSection:
    """The sole from above: a little wider than the upper all around."""
    stations = np.array(_STATIONS)
    x, middle, half = stations[:, 0] * length, stations[:, 1] * width, stations[:, 2] * width / 2
    right = np.column_stack([x, middle - half])
    left = np.column_stack([x, middle + half])[::-1]
    return CrossSection([np.vstack([right, left])]).offset(0.0012, circular_segments=12)
