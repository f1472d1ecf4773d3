"""The catalogue: closed meshes, their mass properties, splits and names."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from keypush.errors import UserError
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import make_object, parse_object_list
from keypush.objects.model import ObjectModel

NAMES = catalogue_names()


@pytest.fixture(params=NAMES)
def model(request: pytest.FixtureRequest) -> ObjectModel:
    return make_object(request.param)


def base_faces(model: ObjectModel) -> np.ndarray:
    height = model.vertices[model.faces][:, :, 2]
    return np.asarray(model.faces[(height < -model.rest_height + 1e-6).all(axis=1)])


def test_meshes_are_closed_and_face_outwards(model: ObjectModel) -> None:
    assert model.mesh.is_watertight
    assert model.mesh.is_winding_consistent
    assert model.mesh.volume > 0
    assert model.mesh.area_faces.min() > 1e-8


def test_the_mug_has_one_handle_and_the_others_none(model: ObjectModel) -> None:
    assert model.mesh.euler_number == (0 if model.name == "mug" else 2)


def test_the_mug_is_hollow() -> None:
    mug = make_object("mug")
    assert mug.mesh.volume < 0.5 * mug.mesh.convex_hull.volume


def test_meshes_have_few_faces(model: ObjectModel) -> None:
    assert len(model.faces) <= 460


def test_the_origin_is_the_centre_of_the_bounding_box(model: ObjectModel) -> None:
    np.testing.assert_allclose(model.mesh.bounds.sum(axis=0), 0.0, atol=1e-12)


@settings(deadline=None, max_examples=20)
@given(st.sampled_from(NAMES), st.floats(0.25, 3.0), st.floats(0.01, 10.0))
def test_size_and_mass_scale_as_they_should(name: str, ratio: float, mass: float) -> None:
    one, other = make_object(name), make_object(name, ratio, mass)
    assert other.bounding_radius == pytest.approx(0.05 * ratio)
    assert other.mass == mass
    np.testing.assert_allclose(other.mesh.extents, ratio * one.mesh.extents)
    np.testing.assert_allclose(other.p_OoOcm_O, ratio * one.p_OoOcm_O, atol=1e-9)
    expected = one.I_OOcm_O * ratio**2 * mass / one.mass
    np.testing.assert_allclose(other.I_OOcm_O, expected, atol=1e-6 * np.trace(expected))


def test_the_base_is_flat_and_rimmed_by_narrow_faces(model: ObjectModel) -> None:
    """The hull of the centroids is what hydroelastic contact supports the object on."""
    base = base_faces(model)
    centroids = model.vertices[base].mean(axis=1)[:, :2]
    np.testing.assert_allclose(model.vertices[base][:, :, 2], -model.rest_height, atol=1e-9)
    for angle in np.arange(0.0, 2 * np.pi, 0.01):
        direction = np.array([np.cos(angle), np.sin(angle)])
        true = (model.support_polygon @ direction).max()
        assert true - 0.001 < (centroids @ direction).max() < true


def test_the_base_is_covered_once(model: ObjectModel) -> None:
    """The base's area from its triangles is that of its outline, by the boundary edges."""
    base = base_faces(model)
    a, b, c = (model.vertices[base][:, k, :2] for k in range(3))
    signed = -0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (signed > 0).all()
    convex = model.name != "l_block"
    polygon = model.support_polygon
    x, y = polygon.T
    hull = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    # The L lacks the triangle between its arms: half of (60 - 25) x (60 - 25) of 60 x 60 parts.
    side = np.ptp(polygon[:, 0])
    missing = 0.0 if convex else 0.5 * (35 / 60 * side) ** 2
    assert signed.sum() == pytest.approx(hull - missing)


def test_inertia_of_the_box_is_exact() -> None:
    model = make_object("box", mass=0.3)
    x, y, z = model.mesh.extents
    expected = 0.3 / 12 * np.diag([y**2 + z**2, x**2 + z**2, x**2 + y**2])
    np.testing.assert_allclose(model.I_OOcm_O, expected, atol=1e-12)
    np.testing.assert_allclose(model.p_OoOcm_O, 0.0, atol=1e-12)


@pytest.mark.parametrize(("name", "segments"), [("can", 24), ("candle", 24), ("disc", 32)])
def test_inertia_of_a_cylinder_is_that_of_its_regular_polygon(name: str, segments: int) -> None:
    """J about the axis of a regular prism: m R^2 / 6 (2 + cos(2 pi / n)), R its circumradius."""
    model = make_object(name)
    radius = np.linalg.norm(model.vertices[:, :2], axis=1).max()
    height = model.mesh.extents[2]
    axial = model.mass * radius**2 / 6 * (2 + np.cos(2 * np.pi / segments))
    across = axial / 2 + model.mass * height**2 / 12
    expected = np.diag([across, across, axial])
    np.testing.assert_allclose(model.I_OOcm_O, expected, atol=1e-9 * axial)
    cylinder = model.mass * radius**2 / 2
    assert axial == pytest.approx(cylinder, rel=0.03)


def test_the_com_of_the_l_block_is_that_of_its_two_arms() -> None:
    model = make_object("l_block")
    side = model.mesh.extents[0]
    arm = 25 / 60 * side
    areas = np.array([side * arm, (side - arm) * arm])
    x = areas @ np.array([side / 2, arm / 2]) / areas.sum() - side / 2
    np.testing.assert_allclose(model.p_OoOcm_O, [x, x, 0.0], atol=1e-9)


def test_com_lies_over_the_support_polygon(model: ObjectModel) -> None:
    polygon = model.support_polygon
    edge = np.roll(polygon, -1, axis=0) - polygon
    offset = model.p_OoOcm_O[:2] - polygon
    assert (edge[:, 0] * offset[:, 1] - edge[:, 1] * offset[:, 0] > 0).all()


def test_reference_points_are_the_corners_of_the_bounding_box(model: ObjectModel) -> None:
    points = model.reference_points
    assert points.shape == (8, 3)
    assert len(np.unique(points.round(9), axis=0)) == 8
    np.testing.assert_allclose(np.abs(points), np.tile(model.mesh.extents / 2, (8, 1)))


def test_surface_points_are_uniform_by_area(model: ObjectModel) -> None:
    """Moments up to the second of 20 000 points agree with those of the triangles."""
    points = model.surface_points(20_000, np.random.default_rng(3))
    area = np.asarray(model.mesh.area_faces) / model.mesh.area
    a, b, c = np.moveaxis(model.vertices[model.faces], 1, 0)
    mean = area @ ((a + b + c) / 3)
    square = area @ ((a * a + b * b + c * c + a * b + b * c + a * c) / 6)
    np.testing.assert_allclose(points.mean(axis=0), mean, atol=1e-3)
    np.testing.assert_allclose((points**2).mean(axis=0), square, atol=2.5e-5)


def test_surface_points_lie_on_the_surface_and_depend_on_the_generator_alone() -> None:
    model = make_object("mug")
    points = model.surface_points(64, np.random.default_rng(1))
    corners = model.vertices[model.faces]
    normals = np.asarray(model.mesh.face_normals)
    height = np.abs(np.einsum("fd,nfd->nf", normals, points[:, None] - corners[None, :, 0]))
    assert height.min(axis=1).max() < 1e-9
    np.testing.assert_array_equal(points, model.surface_points(64, np.random.default_rng(1)))
    assert not np.array_equal(points, model.surface_points(64, np.random.default_rng(2)))


def test_splits_are_disjoint_and_complete() -> None:
    train, unseen = catalogue_names("train"), catalogue_names("unseen")
    assert len(train) == 6
    assert len(unseen) == 2
    assert sorted(train + unseen) == sorted(NAMES)


def test_object_lists() -> None:
    assert parse_object_list("all") == NAMES
    assert parse_object_list("unseen") == catalogue_names("unseen")
    assert parse_object_list(" can, mug,can") == ["can", "mug"]


@pytest.mark.parametrize("text", ["teapot", "mug,teapot", "Mug"])
def test_an_unknown_name_is_refused_with_the_names_there_are(text: str) -> None:
    with pytest.raises(UserError, match=r"'(teapot|Mug)'.*box, tall_box, can, bottle, mug"):
        parse_object_list(text)
    with pytest.raises(UserError, match="allowed"):
        make_object(text)


def test_an_empty_list_or_unknown_split_is_refused() -> None:
    with pytest.raises(UserError, match="allowed: all, train, unseen, box"):
        parse_object_list(" , ")
    with pytest.raises(UserError, match="'test'; allowed: train, unseen"):
        catalogue_names("test")
