"""Animals and things with wheels or soles: elephant, piggy bank, duck, shoe, toy car.

All look towards +x.
"""

import numpy as np
from manifold3d import Manifold

from keypush.objects.generators.solids import (
    above_ground,
    box,
    cone,
    curve,
    cylinder,
    ellipsoid,
    rod,
    rounded_box,
    side_plate,
    sweep,
    union,
)

_SEAM = 2e-4
"""How far (m) a surface may move where two parts meet, so that no slivers stay there."""


def elephant(
    *,
    body_length: float = 0.060,
    body_radius: float = 0.020,
    leg_height: float = 0.016,
    leg_radius: float = 0.008,
    head_radius: float = 0.015,
    ear_radius: float = 0.015,
    trunk_radius: float = 0.0065,
) -> Manifold:
    """Builds an elephant whose trunk hangs down and curls forward.

    Args:
        body_length: of the trunkless, headless body (m).
        body_radius: half its width (m).
        leg_height: from the ground to the belly (m).
        leg_radius: of a leg at its foot (m).
        head_radius: half its width (m).
        ear_radius: half the height of an ear (m).
        trunk_radius: of the trunk where it leaves the head (m).
    """
    middle = leg_height + 1.05 * body_radius
    body = _barrel(body_length, body_radius, 1.05 * body_radius, middle)
    stance = (0.26 * body_length, 0.54 * body_radius)
    x, z = body_length / 2 + 0.15 * head_radius, middle + 0.6 * head_radius
    head = ellipsoid((1.05 * head_radius, head_radius, 1.15 * head_radius), (x, 0.0, z), 16)
    nose = x + 0.75 * head_radius
    bends = [(-0.006, 1.0), (0.006, 0.70), (0.007, 0.38), (0.014, 0.22)]
    path = curve([(nose + out, 0.0, up * z) for out, up in bends], 2)
    trunk = sweep(path, np.linspace(trunk_radius, 0.6 * trunk_radius, len(path)), 8)
    ear = Manifold.cylinder(0.0038, 1.0, 1.0, 12, center=True)
    ear = ear.scale((0.85 * ear_radius, ear_radius, 1.0)).rotate((90.0, 0.0, 0.0))
    ear = ear.translate((-0.7 * ear_radius, 0.0, 0.0)).rotate((8.0, 0.0, -42.0))
    ear = ear.translate((x, 0.72 * head_radius, z))
    rump = -0.48 * body_length
    tail = rod((rump, 0.0, middle + 0.008), (rump - 0.007, 0.0, middle - 0.008), 0.0030, 8)
    parts = [body, head, trunk, ear, ear.mirror((0.0, 1.0, 0.0)), tail]
    return _standing([*parts, *_legs(stance, 0.85 * middle, leg_radius)])


def piggy_bank(
    *,
    body_length: float = 0.070,
    body_radius: float = 0.025,
    leg_height: float = 0.009,
    leg_radius: float = 0.008,
    snout_radius: float = 0.0095,
    slot_length: float = 0.020,
) -> Manifold:
    """Builds a piggy bank: a round pig with a slot in its back.

    Args:
        body_length: without snout and tail (m).
        body_radius: half its width (m).
        leg_height: from the ground to the belly (m).
        leg_radius: of a leg at its foot (m).
        snout_radius: of the snout's flat end (m).
        slot_length: of the slot (m).
    """
    middle = leg_height + body_radius
    front = body_length / 2
    body = _barrel(body_length, body_radius, body_radius, middle)
    stance = (0.25 * body_length, 0.50 * body_radius)
    nose_z = middle + 0.002
    snout = cone(
        (front - 0.008, 0.0, nose_z),
        (front + 0.007, 0.0, nose_z),
        1.2 * snout_radius,
        snout_radius,
        16,
    )
    ear = _pig_ear(front, body_radius, middle)
    top = middle + body_radius
    slot = box((slot_length, 0.005, 0.02), (-0.004, 0.0, top - 0.004))
    tail = _curl().translate((-front + 0.004, 0.0, middle + 0.002))
    parts = [body, snout, ear, ear.mirror((0.0, 1.0, 0.0)), tail]
    return _standing([*parts, *_legs(stance, 0.7 * middle, leg_radius)]) - slot


def duck(
    *,
    body_length: float = 0.066,
    body_radius: float = 0.025,
    base_cut: float = 0.006,
    head_radius: float = 0.0165,
    head_height: float = 0.047,
    beak_length: float = 0.014,
) -> Manifold:
    """Builds a bath duck with a flat bottom.

    Args:
        body_length: without the tail's tip (m).
        body_radius: half its width (m).
        base_cut: what is cut off the round belly (m).
        head_radius: of the head (m).
        head_height: of the head's middle (m).
        beak_length: how far the beak stands out of the head (m).
    """
    depth = 0.8 * body_radius
    middle = depth - base_cut
    body = ellipsoid((body_length / 2, body_radius, depth), (0.0, 0.0, middle), 20)
    rump = ellipsoid(
        (0.28 * body_length, 0.8 * body_radius, 0.8 * depth), (-0.18 * body_length, 0.0, middle), 16
    )
    tip = ellipsoid((0.003, 0.005, 0.003), (-0.60 * body_length, 0.0, middle + 0.95 * depth), 12)
    x = 0.22 * body_length
    head = Manifold.sphere(head_radius, 20).translate((x, 0.0, head_height))
    throat = (x - 0.002, 0.0, head_height - 0.75 * head_radius)
    neck = ellipsoid((0.95 * head_radius, 0.85 * head_radius, 0.8 * head_radius), throat, 16)
    beak_x, beak_z = x + head_radius - 0.003, head_height - 0.15 * head_radius
    bill = ellipsoid((beak_length + 0.003, 0.009, 0.0036), (beak_x, 0.0, beak_z), 12)
    lip = ellipsoid((0.7 * beak_length, 0.008, 0.006), (beak_x, 0.0, beak_z + 0.001), 12)
    wing = ellipsoid((0.27 * body_length, 0.0055, 0.55 * depth), (0.0, 0.0, 0.0), 12)
    wing = wing.rotate((22.0, 14.0, -4.0)).translate(
        (-0.10 * body_length, 0.84 * body_radius, middle + 0.36 * depth)
    )
    tail = Manifold.batch_hull([rump, tip])
    return _standing([body, tail, head, neck, bill, lip, wing, wing.mirror((0.0, 1.0, 0.0))])


def toy_car(
    *,
    length: float = 0.084,
    width: float = 0.038,
    wheel_radius: float = 0.0115,
    wheel_base: float = 0.050,
    cabin_length: float = 0.048,
    height: float = 0.040,
) -> Manifold:
    """Builds a toy car on four wheels.

    Args:
        length: of the body (m).
        width: of the body (m).
        wheel_radius: of a wheel (m).
        wheel_base: from the front to the rear axle (m).
        cabin_length: at the cabin's foot (m).
        height: of the roof (m).
    """
    flat = 0.0008
    axle = wheel_radius - flat
    x, waist = length / 2, 0.025
    hull = side_plate(
        [(-x, 0.008), (x, 0.008), (x, 0.019), (0.92 * x, 0.023), (-0.92 * x, waist), (-x, 0.021)],
        width,
    ) ^ rounded_box((length, width, height), 0.008)
    foot, roof = cabin_length / 2, 0.30 * cabin_length
    cabin = side_plate(
        [(-foot, 0.022), (foot, 0.022), (0.62 * roof, height), (-1.15 * roof, height)], 0.84 * width
    ).translate((-0.05 * length, 0.0, 0.0))
    reach = wheel_base / 2
    wheels = [
        _across(i * reach, 0.30 * width, width / 2 + 0.004, axle, wheel_radius) for i in (-1, 1)
    ]
    lamp = cylinder((0.9 * x, 0.31 * width, 0.016), (x + 0.003, 0.31 * width, 0.016), 0.0042, 12)
    lamps = [lamp, lamp.mirror((0.0, 1.0, 0.0))]
    return _standing([hull, cabin, *wheels, *lamps])


def _pig_ear(front: float, radius: float, middle: float) -> Manifold:
    """The left ear of a pig whose body has this radius about z = `middle`."""
    corners = [(0.40, 0.16, 0.85), (0.46, 0.70, 0.48), (0.74, 0.58, 1.08)]
    balls = [
        Manifold.sphere(0.0024, 8).translate((a * front, b * radius, middle + c * radius))
        for a, b, c in corners
    ]
    return Manifold.batch_hull(balls)


def _curl() -> Manifold:
    """A pig's tail, from the origin backwards."""
    turn = np.linspace(0.0, 1.3 * np.pi, 5)
    path = [-0.003 * turn, 0.006 * np.sin(turn), 0.006 * (1 - np.cos(turn))]
    return sweep(np.column_stack(path), 0.0029, 5)


def _across(x: float, inside: float, outside: float, z: float, radius: float) -> Manifold:
    """Two wheels on one axle, from y = `inside` to `outside` and the same on the other side."""
    wheel = cylinder((x, inside, z), (x, outside, z), radius, 24)
    return wheel + wheel.mirror((0.0, 1.0, 0.0))


def _standing(parts: list[Manifold]) -> Manifold:
    """Joins parts, cuts them off at the ground and merges the slivers along their seams."""
    return above_ground(union(parts)).simplify(_SEAM)


def _barrel(length: float, half_width: float, half_height: float, middle: float) -> Manifold:
    """A long round body along x whose middle line is at the height `middle`."""
    radii = (0.36 * length, half_width, half_height)
    ends = [ellipsoid(radii, (i * (length / 2 - radii[0]), 0.0, middle), 16) for i in (-1, 1)]
    return Manifold.batch_hull(ends)


def _legs(stance: tuple[float, float], height: float, radius: float) -> list[Manifold]:
    """Four legs at (+-x, +-y), a little thinner at the foot than at the body."""
    x, y = stance
    return [
        cone((i * x, j * y, -0.002), (i * x, j * 0.9 * y, height), radius, 1.1 * radius, 8)
        for i in (-1, 1)
        for j in (-1, 1)
    ]
