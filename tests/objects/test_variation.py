"""Variation: draws that depend on seed and episode alone, centres of mass that can be."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from keypush.objects.library import make_object
from keypush.objects.mass import uniform_density
from keypush.objects.model import ObjectModel
from keypush.objects.plant import spatial_inertia
from keypush.objects.variation import (
    MOST_OF_REACH,
    ObjectVariation,
    draw_variation,
    shift_com,
    vary_object,
    with_mass,
)
from keypush.scenario import VARIED_FIELDS, ObjectConfig, Scenario, VariationConfig

Array = NDArray[np.float64]
MARGIN = 0.005


def solid(mesh: trimesh.Trimesh, mass: float = 0.1) -> ObjectModel:
    """An object of uniform density; its other fields are the can's."""
    com, inertia = uniform_density(mesh, mass)
    return dataclasses.replace(
        make_object("can"), mesh=mesh, mass=mass, p_OoOcm_O=com, I_OOcm_O=inertia
    )


def cylinder(radius: float) -> ObjectModel:
    return solid(trimesh.creation.cylinder(radius, 0.06))


@st.composite
def models(draw: st.DrawFn) -> ObjectModel:
    """Catalogue objects, and convex hulls of random points on a flat base."""
    if draw(st.booleans()):
        return make_object(
            draw(st.sampled_from(["can", "mug", "bottle"])), draw(st.floats(0.5, 2.0)), draw(MASSES)
        )
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    points = rng.uniform(-1, 1, (draw(st.integers(8, 30)), 3))
    points[:7, 2] = [-1, -1, -1, -1, -1, 1, 1]
    mesh = trimesh.convex.convex_hull(points * draw(HALF_EXTENTS))
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    return solid(mesh, draw(MASSES))


MASSES = st.floats(0.01, 5.0)
HALF_EXTENTS = st.tuples(*[st.floats(0.015, 0.1)] * 3).map(np.array)
ANGLES = st.floats(-np.pi, np.pi)
SHIFTS = st.floats(1e-4, 0.08)
MARGINS = st.floats(0.0, 0.01)


def unit(angle: float) -> Array:
    return np.array([np.cos(angle), np.sin(angle)])


def support_distance(model: ObjectModel, point: Array) -> float:
    """How far a point (2,) is inside the support polygon; negative outside."""
    hull = ConvexHull(model.support_polygon)
    return float(-np.max(hull.equations[:, :2] @ point + hull.equations[:, 2]))


def hull_distance(model: ObjectModel) -> float:
    """How far the COM is inside the convex hull."""
    equations = ConvexHull(model.vertices).equations
    return float(-np.max(equations[:, :3] @ model.p_OoOcm_O + equations[:, 3]))


def pseudo_inertia(model: ObjectModel) -> Array:
    """Sigma, h; h, m about Oo, lengths in units of the object's radius and mass in its own."""
    moment, c, scale = model.I_OOcm_O, model.p_OoOcm_O, model.bounding_radius
    sigma = np.trace(moment) / 2 * np.eye(3) - moment + model.mass * np.outer(c, c)
    top = np.column_stack([sigma / scale**2, model.mass * c / scale])
    return np.vstack([top, [*(model.mass * c / scale), model.mass]]) / model.mass


@given(models(), ANGLES, SHIFTS, MARGINS)
def test_a_shifted_object_is_physically_consistent(
    model: ObjectModel, angle: float, shift: float, margin: float
) -> None:
    moved = shift_com(model, shift * unit(angle), margin).model
    assert np.linalg.eigvalsh(pseudo_inertia(moved)).min() > 1e-6
    a, b, c = np.linalg.eigvalsh(moved.I_OOcm_O)
    assert 0 < a <= b <= c <= a + b
    assert spatial_inertia(moved).IsPhysicallyValid()
    assert hull_distance(moved) > 0
    assert (moved.mass, moved.mesh) == (model.mass, model.mesh)


@given(models(), ANGLES, SHIFTS, MARGINS)
def test_the_com_moves_as_far_as_asked_for_or_to_the_cap(
    model: ObjectModel, angle: float, shift: float, margin: float
) -> None:
    u = unit(angle)
    varied = shift_com(model, shift * u, margin)
    change = varied.model.p_OoOcm_O - model.p_OoOcm_O
    np.testing.assert_allclose(change, [*varied.com_offset, 0.0], atol=1e-12)
    distance = float(varied.com_offset @ u)
    np.testing.assert_allclose(varied.com_offset, distance * u, atol=1e-12)
    here = model.p_OoOcm_O[:2]
    inside = support_distance(model, here + varied.com_offset)
    if not varied.com_capped:
        assert distance == pytest.approx(shift)
        assert inside >= margin - 1e-9
        return
    assert distance < shift
    # A hair farther would be too near to the support polygon's edge, or to the hull's.
    farther = here + (distance + 1e-6) * u
    too_near = support_distance(model, farther) < margin
    deeper = (distance + 1e-6) / MOST_OF_REACH * u
    beyond = dataclasses.replace(model, p_OoOcm_O=model.p_OoOcm_O + np.array([*deeper, 0.0]))
    unmoved_is_too_near = support_distance(model, here) < margin
    assert too_near or hull_distance(beyond) < 0 or unmoved_is_too_near
    if unmoved_is_too_near:
        assert distance == 0.0
    else:
        assert inside >= margin - 1e-9


@given(models(), ANGLES, MARGINS)
def test_no_shift_is_the_object_itself(model: ObjectModel, angle: float, margin: float) -> None:
    varied = shift_com(model, 0.0 * unit(angle), margin)
    assert varied.model is model
    assert not varied.com_capped
    # ... and small shifts come near to it.
    near = shift_com(model, 1e-9 * unit(angle), 0.0)
    if not near.com_capped:
        scale = np.trace(model.I_OOcm_O)
        np.testing.assert_allclose(near.model.I_OOcm_O, model.I_OOcm_O, atol=1e-5 * scale)


@given(models(), ANGLES, SHIFTS, MARGINS, st.sampled_from([[-1, 1, 1], [1, -1, 1]]))
def test_a_mirrored_object_has_the_mirrored_shift(
    model: ObjectModel, angle: float, shift: float, margin: float, signs: list[int]
) -> None:
    S = np.diag(np.array(signs, dtype=float))
    mesh = trimesh.Trimesh(model.vertices @ S, model.faces[:, ::-1], process=False)
    mirrored = dataclasses.replace(
        model, mesh=mesh, p_OoOcm_O=S @ model.p_OoOcm_O, I_OOcm_O=S @ model.I_OOcm_O @ S
    )
    offset = shift * unit(angle)
    one, other = (
        shift_com(model, offset, margin),
        shift_com(mirrored, S[:2, :2] @ offset, margin),
    )
    assert one.com_capped == other.com_capped
    np.testing.assert_allclose(other.com_offset, S[:2, :2] @ one.com_offset, atol=1e-9)
    expected = S @ one.model.I_OOcm_O @ S
    np.testing.assert_allclose(other.model.I_OOcm_O, expected, atol=1e-6 * np.trace(expected))


@given(models(), ANGLES, SHIFTS)
def test_inertia_is_that_of_the_rest_and_the_lump(
    model: ObjectModel, angle: float, shift: float
) -> None:
    """Composed by Drake, about Oo: the rest as before, and a particle on the way to the hull."""
    varied = shift_com(model, shift * unit(angle), 0.0)
    s = float(np.hypot(*varied.com_offset))
    assume(s > 0)
    u = np.array([*varied.com_offset / s, 0.0])
    # r by bisection along u.
    low, high = 0.0, 2 * model.bounding_radius
    for _ in range(60):
        middle = (low + high) / 2
        at = dataclasses.replace(model, p_OoOcm_O=model.p_OoOcm_O + middle * u)
        low, high = (middle, high) if hull_distance(at) > 0 else (low, middle)
    d = (s + low) / 2
    lump = dataclasses.replace(
        model, mass=model.mass * s / d, p_OoOcm_O=model.p_OoOcm_O + d * u, I_OOcm_O=np.zeros((3, 3))
    )
    total = spatial_inertia(with_mass(model, model.mass * (1 - s / d)))
    total += spatial_inertia(lump)
    scale = model.mass * model.bounding_radius**2
    np.testing.assert_allclose(
        spatial_inertia(varied.model).CopyToFullMatrix6(),
        total.CopyToFullMatrix6(),
        atol=1e-6 * max(scale, model.mass),
    )


@pytest.mark.parametrize(("radius", "capped"), [(0.04, False), (0.0205, False), (0.019, True)])
def test_a_shift_of_15_mm_is_capped_where_the_base_is_narrow(radius: float, capped: bool) -> None:
    varied = shift_com(cylinder(radius), np.array([0.015, 0.0]), MARGIN)
    assert varied.com_capped == capped
    expected = radius - MARGIN if capped else 0.015
    np.testing.assert_allclose(varied.com_offset, [expected, 0.0], atol=1e-4)


def test_no_com_comes_nearer_to_the_hull_than_a_tenth_of_the_way() -> None:
    """With a base wider than the body at the height of its centre of mass."""
    radius, height = 0.04, 0.1
    mesh = trimesh.creation.cone(radius, height)
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    varied = shift_com(solid(mesh), np.array([0.05, 0.0]), 0.001)
    assert varied.com_capped
    assert varied.com_offset[0] == pytest.approx(MOST_OF_REACH * 0.75 * radius, rel=0.01)


def test_a_com_that_is_too_near_to_the_edge_stays() -> None:
    model = cylinder(0.02)
    varied = shift_com(model, np.array([0.015, 0.0]), 0.021)
    assert varied.model is model
    assert varied.com_capped
    np.testing.assert_array_equal(varied.com_offset, np.zeros(2))


@given(MASSES, MASSES)
def test_mass_scales_inertia(before: float, after: float) -> None:
    model = make_object("mug", 1.0, before)
    expected = make_object("mug", 1.0, after)
    np.testing.assert_allclose(with_mass(model, after).I_OOcm_O, expected.I_OOcm_O, rtol=1e-12)
    assert with_mass(model, after).mass == after
    assert with_mass(model, before) is model


FACTORS = {"size": [0.75, 1.25], "mass": [0.5, 2.0], "object_friction": [0.8, 1.2],
           "table_friction": [0.5, 1.5], "gripper_friction": [0.9, 1.1]}  # fmt: skip
COLUMN: dict[str, Callable[[ObjectVariation], float]] = {
    "size": lambda v: v.size_ratio,
    "mass": lambda v: v.mass_factor,
    "object_friction": lambda v: v.object_friction,
    "table_friction": lambda v: v.table_friction,
    "gripper_friction": lambda v: v.gripper_friction,
}


def _scenario(fields: dict[str, list[float]], seed: int = 0) -> Scenario:
    variation = VariationConfig(com_shift=0.015)
    for name, factors in fields.items():
        setattr(variation, name, factors)
    return Scenario(seed=seed, variation=variation)


def _base(name: str) -> float:
    if name == "mass":  # a factor on the object's own
        return 1.0
    section, field = VARIED_FIELDS[name]
    return float(getattr(getattr(Scenario(), section), field))


def test_draws_are_uniform_between_the_factors() -> None:
    draws = [draw_variation(_scenario(FACTORS), episode) for episode in range(400)]
    for name, (low, high) in FACTORS.items():
        share = (np.array([COLUMN[name](d) for d in draws]) / _base(name) - low) / (high - low)
        assert np.all((share >= 0) & (share <= 1))
        counts, _ = np.histogram(share, bins=4, range=(0, 1))
        # 100 expected in each; four standard deviations of a binomial draw.
        assert np.all(np.abs(counts - 100) < 4 * np.sqrt(400 * 3 / 16)), name
    shifts = np.array([d.com_shift for d in draws])
    np.testing.assert_allclose(np.hypot(*shifts.T), 0.015)
    counts, _ = np.histogram(np.arctan2(*shifts.T), bins=4, range=(-np.pi, np.pi))
    assert np.all(np.abs(counts - 100) < 4 * np.sqrt(400 * 3 / 16))
    columns = np.array([[COLUMN[name](d) for name in FACTORS] for d in draws])
    correlation = np.corrcoef(columns.T) - np.eye(len(FACTORS))
    assert np.abs(correlation).max() < 4 / np.sqrt(400)


def test_without_variation_every_value_is_the_scenarios_to_the_bit() -> None:
    scenario = Scenario(object=ObjectConfig(size_ratio=0.9, mass=0.123, friction=0.6789))
    drawn = draw_variation(scenario, 7)
    assert (drawn.size_ratio, drawn.mass_factor, drawn.object_friction) == (0.9, 1.0, 0.6789)
    assert (drawn.table_friction, drawn.gripper_friction) == (0.4, 1.0)
    model = make_object("mug", 0.9, 0.123)
    assert vary_object(model, drawn, MARGIN).model is model


def test_draws_depend_on_seed_and_episode() -> None:
    def key(seed: int, episode: int) -> tuple[float, ...]:
        drawn = draw_variation(_scenario(FACTORS, seed), episode)
        return (*(column(drawn) for column in COLUMN.values()), *drawn.com_shift)

    assert key(3, 5) == key(3, 5)
    assert len({key(seed, episode) for seed in (3, 4) for episode in (5, 6)}) == 4


def test_what_else_varies_does_not_change_a_draw() -> None:
    everything = draw_variation(_scenario(FACTORS), 2)
    for name, factors in FACTORS.items():
        alone = draw_variation(_scenario({name: factors}), 2)
        assert COLUMN[name](alone) == COLUMN[name](everything)
        np.testing.assert_array_equal(alone.com_shift, everything.com_shift)
