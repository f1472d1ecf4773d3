"""The built-in objects: what is stored of them, their splits and names."""

import dataclasses

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RotationMatrix

from keypush.errors import UserError
from keypush.learning.config import TrainingConfig
from keypush.objects.asset import BOUNDING_RADIUS
from keypush.objects.catalogue import GROUPS, catalogue, catalogue_names
from keypush.objects.library import load_object, make_object, parse_object_list
from keypush.objects.mass import uniform_density
from keypush.objects.meshing.distance import hausdorff
from keypush.objects.meshing.felt import felt_points, support_gap
from keypush.objects.point_cloud import sensed_points
from keypush.objects.resting import (
    LEAST_TIPPING_ANGLE,
    TOUCH_TOLERANCE,
    edge_distance,
    support_polygon,
)
from keypush.scenario import NoiseConfig
from keypush.scenario_check import SURFACE_POINTS
from tests.objects.every_object import EVERY_OBJECT

NAMES = catalogue_names()
MOST_FACES = 465


@EVERY_OBJECT
def test_what_touches_is_closed_faces_outwards_and_has_few_faces(name: str) -> None:
    mesh = load_object(name).collision
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    assert mesh.area_faces.min() > 1e-8
    assert len(mesh.faces) <= MOST_FACES


@EVERY_OBJECT
def test_what_is_seen_is_closed_and_faces_outwards(name: str) -> None:
    mesh = load_object(name).visual
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0


@EVERY_OBJECT
def test_what_touches_is_near_what_is_seen(name: str) -> None:
    asset = load_object(name)
    assert hausdorff(asset.collision, asset.visual) < 1.5e-3


@EVERY_OBJECT
def test_every_stable_pose_is_felt_to_1_mm(name: str) -> None:
    asset = load_object(name)
    for pose in asset.poses:
        felt = felt_points(asset.collision, pose.R_WO)
        true = support_polygon(np.asarray(asset.visual.vertices), pose.R_WO, TOUCH_TOLERANCE)
        assert support_gap(felt, true) < 1e-3
    assert asset.provenance["poses_left_out"] == 0


@EVERY_OBJECT
def test_upright_is_the_first_of_its_stable_poses(name: str) -> None:
    asset, model = load_object(name), make_object(name)
    upright = asset.poses[0]
    assert upright.R_WO.IsExactlyEqualTo(RotationMatrix())
    assert upright.height == pytest.approx(model.rest_height, abs=1e-6)
    for pose in asset.poses:
        assert pose.tipping_angle >= LEAST_TIPPING_ANGLE
        assert 0 < pose.share < 1
        lowest = (np.asarray(asset.visual.vertices) @ pose.R_WO.matrix().T)[:, 2].min()
        assert -lowest == pytest.approx(pose.height, abs=TOUCH_TOLERANCE)
    assert sum(pose.share for pose in asset.poses) < 1 + 1e-9


@EVERY_OBJECT
def test_the_com_lies_well_inside_the_support_polygon(name: str) -> None:
    model = make_object(name)
    inside = edge_distance(model.support_polygon, model.p_OoOcm_O[:2])
    angle = np.arctan2(inside, model.p_OoOcm_O[2] + model.rest_height)
    assert angle > LEAST_TIPPING_ANGLE - 0.03  # what touches has corners up to 1 mm inside


@EVERY_OBJECT
def test_the_origin_is_the_middle_of_the_bounding_box_and_the_sphere_touches(name: str) -> None:
    vertices = np.asarray(load_object(name).visual.vertices)
    np.testing.assert_allclose(vertices.min(axis=0) + vertices.max(axis=0), 0.0, atol=1e-8)
    assert np.linalg.norm(vertices, axis=1).max() == pytest.approx(BOUNDING_RADIUS, abs=1e-8)
    assert make_object(name).bounding_radius == pytest.approx(BOUNDING_RADIUS, abs=1e-8)


@EVERY_OBJECT
def test_mass_properties_are_those_of_what_is_seen_with_uniform_density(name: str) -> None:
    asset, model = load_object(name), make_object(name)
    assert model.mass == asset.mass == 0.1
    com, inertia = uniform_density(asset.visual, model.mass)
    np.testing.assert_allclose(model.p_OoOcm_O, com, atol=1e-8)
    np.testing.assert_allclose(model.I_OOcm_O, inertia, atol=1e-6 * np.trace(inertia))


@EVERY_OBJECT
def test_what_is_stored_is_what_the_generator_makes(name: str) -> None:
    asset, entry = load_object(name), catalogue()[name]
    assert asset.provenance["generator"] == entry.generator
    assert asset.provenance["parameters"] == entry.parameters
    assert asset.colour == entry.colour
    made = entry.generate()
    scale = 2 * BOUNDING_RADIUS / _sphere(made)
    assert asset.visual.volume == pytest.approx(made.volume * scale**3, rel=1e-5)
    assert asset.visual.area == pytest.approx(made.area * scale**2, rel=1e-5)
    np.testing.assert_allclose(asset.visual.extents, made.extents * scale, atol=1e-7)


def _sphere(mesh: trimesh.Trimesh) -> float:
    """Diameter of the sphere about the middle of the bounding box."""
    return float(2 * np.linalg.norm(mesh.vertices - mesh.bounds.mean(axis=0), axis=1).max())


def test_no_two_objects_are_the_same() -> None:
    measures = [(load_object(n).visual.volume, load_object(n).visual.area) for n in NAMES]
    assert len({tuple(np.round(np.log(m), 3)) for m in measures}) == len(NAMES)


@given(st.sampled_from(NAMES), st.floats(0.25, 3.0), st.floats(0.01, 10.0))
def test_size_and_mass_scale_as_they_should(name: str, ratio: float, mass: float) -> None:
    one, other = make_object(name), make_object(name, ratio, mass)
    assert other.bounding_radius == pytest.approx(BOUNDING_RADIUS * ratio)
    assert (other.name, other.size_ratio, other.mass) == (name, ratio, mass)
    assert other.rest_height == pytest.approx(one.rest_height * ratio)
    np.testing.assert_allclose(other.mesh.extents, ratio * one.mesh.extents)
    np.testing.assert_allclose(other.visual.extents, ratio * one.visual.extents)
    np.testing.assert_allclose(other.p_OP, ratio * one.p_OP)
    np.testing.assert_allclose(other.p_OoOcm_O, ratio * one.p_OoOcm_O, atol=1e-9)
    expected = one.I_OOcm_O * ratio**2 * mass / one.mass
    np.testing.assert_allclose(other.I_OOcm_O, expected, atol=1e-6 * np.trace(expected))
    com, inertia = uniform_density(other.visual, mass)
    np.testing.assert_allclose(other.p_OoOcm_O, com, atol=1e-8 * ratio)
    np.testing.assert_allclose(other.I_OOcm_O, inertia, atol=1e-6 * np.trace(inertia))


@EVERY_OBJECT
def test_reference_points_are_the_corners_of_the_bounding_box(name: str) -> None:
    model = make_object(name)
    points = model.reference_points
    assert points.shape == (8, 3)
    assert len(np.unique(points.round(9), axis=0)) == 8
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], model.mesh.bounds)
    assert np.all(
        np.isclose(points, model.mesh.bounds[0]) | np.isclose(points, model.mesh.bounds[1])
    )


@EVERY_OBJECT
def test_surface_points_are_uniform_by_area(name: str) -> None:
    """Moments up to the second agree with those of the triangles to what chance allows."""
    model = make_object(name)
    area = np.asarray(model.visual.area_faces) / model.visual.area
    a, b, c = np.moveaxis(np.asarray(model.visual.triangles), 1, 0)
    mean = area @ ((a + b + c) / 3)
    square = area @ ((a * a + b * b + c * c + a * b + b * c + a * c) / 6)
    assert model.p_OP.shape == (SURFACE_POINTS, 3) == (4096, 3)
    for drawn, true in ((model.p_OP, mean), (model.p_OP**2, square)):
        error = np.abs(drawn.mean(axis=0) - true)
        assert np.all(error < 4 * drawn.std(axis=0) / np.sqrt(SURFACE_POINTS))


@EVERY_OBJECT
def test_surface_points_lie_on_what_is_seen(name: str) -> None:
    model = make_object(name)
    few = np.arange(0, SURFACE_POINTS, 16)
    # In mm: at smaller lengths the tolerances of the search are as large as faces.
    seen = trimesh.Trimesh(1e3 * model.visual.vertices, model.visual.faces, process=False)
    _, distance, _ = trimesh.proximity.closest_point_naive(seen, 1e3 * model.p_OP[few])
    assert distance.max() < 1e-6


def test_drawn_points_are_some_of_them_and_depend_on_the_generator_alone() -> None:
    model = make_object("mug")
    points = model.surface_points(64, np.random.default_rng(1))
    assert len(np.unique(points, axis=0)) == 64
    assert (points[:, None] == model.p_OP).all(axis=2).any(axis=1).all()
    np.testing.assert_array_equal(points, model.surface_points(64, np.random.default_rng(1)))
    assert not np.array_equal(points, model.surface_points(64, np.random.default_rng(2)))


def test_a_cloud_may_have_every_point_that_a_scenario_allows() -> None:
    model = make_object("mug")
    for config in (NoiseConfig, TrainingConfig):
        spec = next(f for f in dataclasses.fields(config) if f.name == "cloud_points")
        _, most = spec.metadata["range"]
        assert len(sensed_points(model, most, 0)) == most


def test_splits_are_disjoint_and_complete() -> None:
    splits = [catalogue_names(split) for split in ("train", "id", "ood")]
    assert [len(names) for names in splits] == [16, 6, 10]
    assert sorted(name for names in splits for name in names) == sorted(NAMES)
    assert len(set(NAMES)) == 32
    assert sorted(catalogue_names("unseen")) == sorted(splits[1] + splits[2])


def test_the_ablation_divides_the_training_objects() -> None:
    train, validation = catalogue_names("ablation_train"), catalogue_names("ablation_validation")
    assert (len(train), len(validation)) == (12, 4)
    assert sorted(train + validation) == sorted(catalogue_names("train"))


def test_an_id_object_varies_one_that_is_trained_on_and_an_ood_object_none() -> None:
    trained = {catalogue()[name].generator for name in catalogue_names("train")}
    assert all(catalogue()[name].generator in trained for name in catalogue_names("id"))
    assert not any(catalogue()[name].generator in trained for name in catalogue_names("ood"))


def test_object_lists() -> None:
    for group in GROUPS:
        assert parse_object_list(group) == catalogue_names(group)
    assert parse_object_list("all") == NAMES
    assert parse_object_list(" can, mug,can") == ["can", "mug"]
    assert parse_object_list("mug,ood,ring") == ["mug", *catalogue_names("ood")]


@pytest.mark.parametrize("text", ["teapot", "mug,teapot", "Mug"])
def test_an_unknown_name_is_refused_with_the_names_there_are(text: str) -> None:
    groups, names = ", ".join(GROUPS), ", ".join(NAMES)
    with pytest.raises(UserError, match=rf"'(teapot|Mug)'.*allowed: {groups}, {names}"):
        parse_object_list(text)
    with pytest.raises(UserError, match=f"allowed: {names}"):
        make_object(text)


def test_an_empty_list_or_unknown_group_is_refused() -> None:
    with pytest.raises(UserError, match=r"allowed: train, id, ood, unseen, .*, all, block"):
        parse_object_list(" , ")
    with pytest.raises(UserError, match=r"'test'; allowed: train, id, ood, unseen, .*, all$"):
        catalogue_names("test")
