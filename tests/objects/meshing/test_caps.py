"""Caps cover what their outline encloses, once, in the outline's own points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.errors import GEOSException
from shapely.geometry import Polygon

from keypush.objects.meshing.caps import Cap, triangulate_cap
from keypush.objects.meshing.felt import support_gap
from tests.objects.meshing.solids import STAR

SQUARE = np.array([(0.0, 0.0), (0.05, 0.0), (0.05, 0.05), (0.0, 0.05)])
HOLE = np.array([(0.02, 0.02), (0.02, 0.03), (0.03, 0.03), (0.03, 0.02)])
RIMS = [(0.0, 0.0), (8e-4, 2.5e-3), (5e-4, 0.0)]


def assert_covers(cap: Cap, loops: list[np.ndarray]) -> None:
    outline = np.concatenate(loops)
    np.testing.assert_array_equal(cap.points[: len(outline)], outline)
    a, b, c = np.moveaxis(cap.points[np.array(cap.faces)], 1, 0)
    u, v = b - a, c - a
    signed = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    assert (signed > 0).all()
    area = sum(Polygon(loop).area * (1 if Polygon(loop).exterior.is_ccw else -1) for loop in loops)
    assert cap.areas().sum() == pytest.approx(area)
    edges = {(f[i], f[(i + 1) % 3]) for f in cap.faces for i in range(3)}
    assert len(edges) == 3 * len(cap.faces)
    border = {(i, j) for i, j in edges if (j, i) not in edges}
    starts = np.cumsum([0, *(len(loop) for loop in loops)])
    expected = {
        (s + i, s + (i + 1) % len(loop))
        for s, loop in zip(starts, loops, strict=False)
        for i in range(len(loop))
    }
    assert border == expected


@pytest.mark.parametrize(("rim", "coarse"), RIMS)
@pytest.mark.parametrize(
    "loops", [[SQUARE], [SQUARE, HOLE], [np.array(STAR)], [SQUARE, SQUARE + np.array([0.1, 0.0])]]
)
def test_the_polygon_is_covered_once(loops: list[np.ndarray], rim: float, coarse: float) -> None:
    assert_covers(triangulate_cap(loops, [], rim, coarse), loops)


@given(st.integers(0, 2**32 - 1), st.sampled_from(RIMS))
def test_random_star_shaped_polygons_are_covered(seed: int, rim: tuple[float, float]) -> None:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(5, 25)))
    if np.diff(angle, append=angle[0] + 2 * np.pi).max() > 3.0 or np.diff(angle).min() < 0.02:
        return  # the middle is outside, or two corners are one
    radius = rng.uniform(0.01, 0.05, len(angle))
    loop = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    assert_covers(triangulate_cap([loop], [], *rim), [loop])


def test_ears_and_a_rim_are_felt_near_the_corner() -> None:
    points = []
    for start, end in zip(SQUARE, np.roll(SQUARE, -1, axis=0), strict=True):
        along = (end - start) / 0.05
        points += [start, start + 9e-4 * along, end - 9e-4 * along]
    loop = np.array(points)
    ears = [(0, i) for i in (0, 3, 6, 9)]
    plain = support_gap(triangulate_cap([loop], [], 0.0, 0.0).centroids(), SQUARE)
    eared = triangulate_cap([loop], ears, 0.0, 0.0)
    assert_covers(eared, [loop])
    assert support_gap(eared.centroids(), SQUARE) < 5e-4 < 5e-3 < plain


def test_an_ear_that_would_run_into_a_hole_is_left_out() -> None:
    loop = np.array(
        [(0.0, 0.0), (0.001, 0.0), (0.05, 0.0), (0.05, 0.05), (0.0, 0.05), (0.0, 0.001)]
    )
    hole = np.array([(2e-4, 2e-4), (2e-4, 0.03), (0.03, 2e-4)])
    cap = triangulate_cap([loop, hole], [(0, 0), (0, 3)], 0.0, 0.0)
    assert_covers(cap, [loop, hole])
    assert (5, 0, 1) not in cap.faces
    assert (2, 3, 4) in cap.faces


def test_a_cap_closes_its_own_outline_alone() -> None:
    loops = [[10, 11, 12, 13], [20, 21, 22, 23]]
    cap = triangulate_cap([SQUARE, HOLE], [], 0.0, 0.0)
    assert cap.closes(loops)
    assert not cap.closes([[10, 11, 12, 13, 20, 21, 22, 23]])
    assert not Cap(cap.points, cap.faces[1:]).closes(loops)
    assert not Cap(cap.points, [*cap.faces, cap.faces[0]]).closes(loops)
    assert not triangulate_cap([SQUARE], [], 0.0, 0.0).closes(loops)


def test_a_cap_may_touch_itself_in_a_point() -> None:
    other = SQUARE + 0.05
    cap = triangulate_cap([SQUARE, other], [], 0.0, 0.0)
    # (0.05, 0.05) is a corner of both.
    assert cap.closes([[1, 2, 3, 4], [3, 5, 6, 7]])


@pytest.mark.parametrize("rim", [0.0, 8e-4])
def test_an_outline_that_crosses_itself_is_told(rim: float) -> None:
    crossed = SQUARE[[0, 1, 3, 2]] + np.array([[0, 0], [0, 0], [0, 0], [0.01, 0]])
    try:
        cap = triangulate_cap([crossed], [], rim, 0.0)
    except GEOSException:
        return
    assert not cap.closes([[0, 1, 2, 3]])
