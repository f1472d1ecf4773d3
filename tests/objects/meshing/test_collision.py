"""The collision mesh: closed, near to the solid, few faces, felt where the solid stands."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.math import RotationMatrix

from keypush.objects.generators.solids import box, lathe
from keypush.objects.manifolds import to_mesh
from keypush.objects.meshing.collision import CLOSE_ENOUGH, collision_mesh
from keypush.objects.meshing.distance import hausdorff
from keypush.objects.meshing.felt import FLAT, felt_points, support_gap
from keypush.objects.resting import TOUCH_TOLERANCE, find_resting_poses, support_polygon
from tests.objects.meshing.solids import named_solids

SOLIDS = named_solids()


@pytest.fixture(params=SOLIDS)
def solid(request: pytest.FixtureRequest) -> trimesh.Trimesh:
    mesh = SOLIDS[request.param].copy()
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    return mesh


def assert_true_to(mesh: trimesh.Trimesh, solid: trimesh.Trimesh) -> None:
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.area_faces.min() > 0
    assert len(mesh.faces) <= 450
    assert mesh.volume == pytest.approx(solid.volume, rel=0.05)
    assert hausdorff(mesh, solid) < CLOSE_ENOUGH
    for pose in find_resting_poses(solid, solid.center_mass):
        true = support_polygon(np.asarray(solid.vertices), pose.R_WO, TOUCH_TOLERANCE)
        felt = felt_points(mesh, pose.R_WO)
        assert support_gap(felt, true) < 1e-3
        # No farther out either: nothing supports beyond the true polygon.
        assert support_gap(true, felt) < 2e-4
        low = np.asarray(mesh.vertices) @ pose.R_WO.matrix()[2]
        assert low.min() == pytest.approx(-pose.height, abs=1e-9)


def test_it_is_true_to_the_solid(solid: trimesh.Trimesh) -> None:
    poses = find_resting_poses(solid, solid.center_mass)
    assert_true_to(collision_mesh(solid, poses), solid)


@settings(max_examples=5)
@given(st.integers(0, 2**32 - 1))
def test_any_box_is_kept(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y, z = rng.uniform(0.02, 0.08, size=3)
    solid = to_mesh(box((x, y, z)))
    solid.apply_translation(-solid.bounds.mean(axis=0))
    mesh = collision_mesh(solid, find_resting_poses(solid, solid.center_mass))
    assert_true_to(mesh, solid)
    np.testing.assert_allclose(mesh.bounds, solid.bounds, atol=1e-9)
    assert mesh.volume == pytest.approx(solid.volume)


def test_the_same_solid_gives_the_same_mesh() -> None:
    solid = SOLIDS["stone"]
    poses = find_resting_poses(solid, solid.center_mass)
    first, second = (collision_mesh(solid, poses) for _ in range(2))
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.faces, second.faces)


def test_what_touches_in_a_line_gets_a_flat_base() -> None:
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False) + 0.13
    tyre = lathe([(0.035 + 0.008 * np.cos(a), 0.008 + 0.008 * np.sin(a)) for a in angles], 48)
    solid = to_mesh(tyre)
    solid.apply_translation(-solid.bounds.mean(axis=0))
    mesh = collision_mesh(solid, find_resting_poses(solid, solid.center_mass))
    assert mesh.is_watertight
    assert hausdorff(mesh, solid) < CLOSE_ENOUGH
    low = mesh.bounds[0, 2]
    base = np.flatnonzero((mesh.triangles[:, :, 2] < low + FLAT).all(axis=1))
    assert mesh.area_faces[base].sum() > 1e-4
    true = support_polygon(np.asarray(solid.vertices), RotationMatrix(), TOUCH_TOLERANCE)
    assert support_gap(felt_points(mesh, RotationMatrix()), true) < 1e-3


def test_many_faces_become_few() -> None:
    solid = trimesh.creation.icosphere(subdivisions=5, radius=0.05)
    solid = trimesh.intersections.slice_mesh_plane(solid, [0, 0, 1], [0, 0, -0.03], cap=True)
    assert len(solid.faces) > 10_000
    mesh = collision_mesh(solid, find_resting_poses(solid, solid.center_mass))
    assert mesh.is_watertight
    assert len(mesh.faces) <= 550
    assert hausdorff(mesh, solid) < CLOSE_ENOUGH


def test_a_base_of_two_triangles_would_not_be_felt() -> None:
    """What all of this is for: it fails for the plain mesh of a box."""
    solid = SOLIDS["box"]
    (pose, *_) = find_resting_poses(solid, solid.center_mass)
    true = support_polygon(np.asarray(solid.vertices), pose.R_WO, FLAT)
    assert support_gap(felt_points(solid, pose.R_WO), true) > 0.01
