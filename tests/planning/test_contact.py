"""The analytic contact lies behind the centre of mass, on the object's own outline."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import linprog

from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import make_object
from keypush.planning.contact import analytic_contact
from keypush.planning.push_frame import left_of

Array = NDArray[np.float64]
WIDTH, BAND = 0.02, (0.01, 0.04)
HALF = np.array([0.05, 0.03])
angles = st.floats(-np.pi, np.pi)
offsets = st.lists(st.floats(-0.01, 0.01), min_size=2, max_size=2).map(np.array)
RNG = np.random.default_rng(0)


def _direction(angle: float) -> Array:
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def _wall(outline: Array) -> Array:
    """A wall over an outline, as points in W: 6 cm high, layers 1 cm apart."""
    layers = [np.column_stack([outline, np.full(len(outline), z)]) for z in np.linspace(0, 0.06, 7)]
    return np.concatenate(layers)


def _box() -> Array:
    s = np.linspace(-1.0, 1.0, 801)
    one = np.ones_like(s)
    sides = [(s, one), (s, -one), (one, s), (-one, s)]
    return _wall(np.concatenate([np.column_stack(side) * HALF for side in sides]))


BOX = _box()
TURN = np.linspace(0.0, 2 * np.pi, 3601)
CYLINDER = _wall(0.04 * np.column_stack([np.cos(TURN), np.sin(TURN)]))


@given(angles, offsets)
def test_on_a_cylinder_the_contact_is_the_chords_end(angle: float, off: Array) -> None:
    d_W, com = _direction(angle), np.array([*off, 0.03])
    p_WK = analytic_contact(CYLINDER, com, d_W, WIDTH, BAND)
    # Deepest within the strip of the finger's width, whose middle line goes through the COM.
    lateral = float(off @ left_of(d_W)[:2])
    nearest = np.clip(0.0, lateral - WIDTH, lateral + WIDTH)
    r = float(off @ d_W[:2]) + np.sqrt(0.04**2 - nearest**2)
    np.testing.assert_allclose(p_WK[:2], off - r * d_W[:2], atol=1e-4)
    assert p_WK[2] == BAND[0]


@given(angles, offsets)
def test_on_a_box_the_contact_is_the_deepest_point_of_the_strip(angle: float, off: Array) -> None:
    d_W, com = _direction(angle), np.array([*off, 0.03])
    p_WK = analytic_contact(BOX, com, d_W, WIDTH, BAND)
    left = left_of(d_W)[:2]
    strip = np.vstack([left, -left])
    bound = np.array([WIDTH + off @ left, WIDTH - off @ left])
    limits = [(-h, h) for h in HALF]
    deepest = linprog(d_W[:2], A_ub=strip, b_ub=bound, bounds=limits)
    r = float(off @ d_W[:2]) - deepest.fun
    np.testing.assert_allclose(p_WK[:2], off - r * d_W[:2], atol=3e-4)


@pytest.mark.parametrize(
    ("angle", "extent"), [(0, 0.05), (np.pi, 0.05), (np.pi / 2, 0.03), (-np.pi / 2, 0.03)]
)
def test_along_a_boxs_axis_the_contact_is_its_face(angle: float, extent: float) -> None:
    d_W = _direction(angle)
    p_WK = analytic_contact(BOX, np.array([0.0, 0.0, 0.03]), d_W, WIDTH, BAND)
    np.testing.assert_allclose(p_WK, -extent * d_W + [0.0, 0.0, BAND[0]], atol=1e-9)


@pytest.mark.parametrize("name", catalogue_names())
@given(angle=angles)
def test_it_lies_behind_the_com_within_the_bounding_sphere(name: str, angle: float) -> None:
    model = make_object(name)
    d_W = _direction(angle)
    p_WO = np.array([0.1, -0.1, model.rest_height])
    p_WP, com = model.p_OP + p_WO, model.p_OoOcm_O + p_WO
    p_WK = analytic_contact(p_WP, com, d_W, WIDTH, BAND)
    offset = (p_WK - com)[:2]
    assert np.isclose(offset @ left_of(d_W)[:2], 0.0, atol=1e-12)
    depth = -offset @ d_W[:2]
    assert 0.0 < depth <= np.linalg.norm(p_WP - com, axis=1).max()


def test_points_above_the_finger_do_not_count() -> None:
    """A mushroom: what overhangs high up is not touched by a low finger."""
    stem = 0.4 * BOX[BOX[:, 2] <= BAND[1]]
    stem[:, 2] /= 0.4
    cap = BOX[BOX[:, 2] > BAND[1]]
    both = np.concatenate([stem, cap])
    p_WK = analytic_contact(both, np.array([0.0, 0.0, 0.05]), _direction(0.0), WIDTH, BAND)
    np.testing.assert_allclose(p_WK[0], -0.4 * HALF[0], atol=1e-9)


def test_without_points_in_the_band_or_the_strip_others_count() -> None:
    high = BOX[BOX[:, 2] > BAND[1]]
    p_WK = analytic_contact(high, np.array([0.0, 0.0, 0.05]), _direction(0.0), WIDTH, BAND)
    np.testing.assert_allclose(p_WK[0], -HALF[0], atol=1e-9)
    ends = BOX[np.abs(BOX[:, 1]) > 0.025]
    p_WK = analytic_contact(ends, np.array([0.0, 0.0, 0.03]), _direction(0.0), WIDTH, BAND)
    np.testing.assert_allclose(p_WK[0], -HALF[0], atol=1e-9)
