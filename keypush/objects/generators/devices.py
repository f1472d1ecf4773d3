"""Things with parts that move: telephone, camera, stapler. Fronts look towards -y."""

import numpy as np
from manifold3d import Manifold

from keypush.objects.generators.solids import (
    above_ground,
    cone,
    curve,
    cylinder,
    rounded_box,
    side_plate,
    union,
)


def telephone(
    *,
    width: float = 0.074,
    depth: float = 0.062,
    front_height: float = 0.012,
    back_height: float = 0.030,
    handset_across: int = 0,
) -> Manifold:
    """Builds a desk telephone: a wedge with its handset on the cradle.

    Args:
        width: along x (m).
        depth: along y (m).
        front_height: of the wedge at its front (m).
        back_height: of the wedge at its back (m).
        handset_across: 0: handset along the left side, beside a keypad and a screen;
            1: handset across the back, behind a dial.
    """
    slope = np.arctan2(back_height - front_height, depth)
    middle = (front_height + back_height) / 2
    base = _wedge(width, depth, front_height, back_height)
    if handset_across:
        face = [_dial(0.37 * depth).translate((0.0, -0.12 * depth, 0.0))]
        handset = _handset(0.95 * width).translate((0.0, 0.32 * depth, 0.0))
    else:
        column = 0.17 * width
        face = [
            rounded_box((0.50 * width, 0.46 * depth, 0.004), 0.003, (column, -0.2 * depth, -0.001)),
            rounded_box((0.50 * width, 0.26 * depth, 0.004), 0.003, (column, 0.26 * depth, -0.001)),
        ]
        handset = _handset(depth).rotate((0.0, 0.0, 90.0)).translate((-0.31 * width, 0.0, 0.0))
    top = union([*face, handset])
    return base + top.rotate((float(np.rad2deg(slope)), 0.0, 0.0)).translate((0.0, 0.0, middle))


def camera(
    *,
    width: float = 0.080,
    height: float = 0.046,
    depth: float = 0.030,
    lens_radius: float = 0.018,
    lens_length: float = 0.022,
    hump_width: float = 0.028,
    hump_height: float = 0.010,
) -> Manifold:
    """Builds a camera: body with a grip, lens, viewfinder hump, two buttons.

    Args:
        width: of the body, along x (m).
        height: of the body (m).
        depth: of the body, along y (m).
        lens_radius: of the lens's thickest part (m).
        lens_length: how far the lens stands out (m).
        hump_width: of the viewfinder at its foot (m).
        hump_height: of the viewfinder over the body (m).
    """
    front, axis = -depth / 2, 0.46 * height
    body = rounded_box((width, depth, height), 0.005)
    grip_x = -width / 2 + 0.009
    grip = rounded_box((0.018, 0.014, 0.88 * height), 0.005, (grip_x, front, 0.0))
    ring, end = front - 0.45 * lens_length, front - lens_length
    lens = union(
        [
            cylinder((0.0, 0.0, axis), (0.0, ring, axis), lens_radius, 28),
            cylinder((0.0, 0.0, axis), (0.0, end, axis), 0.84 * lens_radius, 28),
        ]
    )
    opening = cone((0.0, end - 0.001, axis), (0.0, end + 0.006, axis), *_opening(lens_radius), 20)
    hump = _hump(hump_width, hump_height + 0.001, 0.8 * depth)
    hump = hump.translate((0.0, 0.0, height - 0.001))
    button = cylinder((grip_x, front, 0.85 * height), (grip_x, front, 0.88 * height + 0.004), 0.005)
    dial_x = 0.33 * width
    dial = cylinder((dial_x, 0.0, height - 0.001), (dial_x, 0.0, height + 0.005), 0.008, 16)
    return above_ground(union([body, grip, lens, hump, button, dial]) - opening)


def stapler(
    *,
    length: float = 0.090,
    width: float = 0.028,
    height: float = 0.038,
    base_height: float = 0.009,
    gape: float = 0.005,
) -> Manifold:
    """Builds a stapler that stands on its base, its mouth towards +x.

    Args:
        length: of the base (m).
        width: of the base (m).
        height: of the arm's highest point (m).
        base_height: of the base (m).
        gape: gap between base and magazine at the mouth (m).
    """
    x = length / 2
    base = rounded_box((length, width, base_height), 0.009)
    anvil = rounded_box((0.014, 0.6 * width, 0.003), 0.003, (0.78 * x, 0.0, base_height - 0.001))
    # A gap that closes slowly towards the hinge would end in a sliver.
    magazine = [(-0.6 * x, base_height + 0.003), (0.9 * x, base_height + gape)]
    foot = base_height - 0.002
    hinge = [(-0.88 * x, foot), (-0.45 * x, foot), (-0.58 * x, 0.024), (-0.82 * x, 0.024)]
    pin = (-0.7 * x, 0.52 * width, 0.018)
    return union(
        [
            base,
            anvil,
            side_plate([*magazine, (0.9 * x, 0.022), (-0.6 * x, 0.022)], 0.5 * width),
            _stapler_arm(x, width, height, base_height + gape),
            side_plate(hinge, 0.84 * width),
            cylinder((pin[0], -pin[1], pin[2]), pin, 0.0045, 24),
        ]
    )


def _stapler_arm(x: float, width: float, height: float, front: float) -> Manifold:
    """The stapler's arm from -x to x; at its mouth it begins a little above z = `front`."""
    rear = front - 0.001
    lips = [(-0.96 * x, rear), (0.97 * x, front + 0.005)]
    crown = [
        (0.99 * x, front + 0.013),
        (0.90 * x, height - 0.003),
        (0.55 * x, height),
        (-0.10 * x, height - 0.001),
        (-0.60 * x, height - 0.005),
        (-0.96 * x, height - 0.015),
    ]
    wide = [*lips, (0.98 * x, front + 0.012), (-0.94 * x, rear + 0.007)]
    high = np.array([*lips, *curve(crown, 2)])
    return Manifold.batch_hull([side_plate(wide, 0.74 * width), side_plate(high, 0.46 * width)])


def _hump(width: float, height: float, depth: float) -> Manifold:
    """A viewfinder that narrows upwards."""
    outline = np.array([(-0.5, 0.0), (0.5, 0.0), (0.28, 1.0), (-0.28, 1.0)])
    return side_plate(outline * (width, height), depth)


def _opening(lens_radius: float) -> tuple[float, float]:
    """Radii of the recess in front of the glass: at its mouth and at its floor."""
    return 0.84 * lens_radius - 0.003, 0.84 * lens_radius - 0.006


def _wedge(width: float, depth: float, front: float, back: float) -> Manifold:
    """The telephone's base, higher at the back (+y), its corners rounded."""
    y, edge = depth / 2, 0.004
    outline = [
        (-y, 0.0),
        (y, 0.0),
        (y, back - edge),
        (y - edge, back),
        (-y + edge, front),
        (-y, front - edge),
    ]
    return side_plate(outline, width).rotate((0.0, 0.0, 90.0)) ^ rounded_box(
        (width, depth, back), 0.007
    )


def _handset(length: float) -> Manifold:
    """A receiver along x with its two cups on z = 0."""
    x = length / 2
    below = curve([(0.93 * x, 0.008), (0.55 * x, 0.0115), (0.0, 0.0125)], 3)
    above = curve([(0.0, 0.021), (0.55 * x, 0.0195), (0.97 * x, 0.013)], 3)
    right = [*below, *above]
    left = [(-a, z) for a, z in reversed(right)]
    bar = side_plate(np.array([*right, *left[1:-1]]), 0.013)
    cups = [
        cylinder((i * (x - 0.0095), 0.0, -0.001), (i * (x - 0.0095), 0.0, 0.012), 0.0095, 16)
        for i in (-1, 1)
    ]
    return union([bar, *cups])


def _dial(radius: float) -> Manifold:
    """A disc with a ring of finger holes, which is one groove at this size."""
    disc = cylinder((0.0, 0.0, -0.001), (0.0, 0.0, 0.004), radius, 20)
    hub = cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 0.005), 0.42 * radius, 12)
    groove = cylinder((0.0, 0.0, 0.002), (0.0, 0.0, 0.006), 0.78 * radius, 16)
    return disc - groove + hub
