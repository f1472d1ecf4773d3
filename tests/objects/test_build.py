"""From a solid of any size and attitude to an asset."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.math import RollPitchYaw

from keypush.errors import UserError
from keypush.objects.build import BuildOptions, build_asset
from keypush.objects.generators.solids import box, lathe, prism
from keypush.objects.manifolds import to_mesh
from keypush.objects.meshing.felt import MOST_SUPPORT_GAP, pose_support_gap

CUP = lathe([(0, 0), (30, 0), (30, 60), (26, 60), (26, 4), (0, 4)])


def test_it_is_scaled_centred_and_upright() -> None:
    mesh = to_mesh(CUP)
    asset = build_asset("cup", mesh, BuildOptions(up="z"), {})
    assert np.linalg.norm(asset.visual.vertices, axis=1).max() == pytest.approx(0.05)
    np.testing.assert_allclose(asset.visual.bounds.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_array_equal(asset.poses[0].R_WO.matrix(), np.eye(3))
    assert asset.poses[0].height == pytest.approx(-asset.visual.bounds[0, 2])
    assert asset.mass == 0.1
    assert asset.p_OoOcm_O[2] < 0  # its bottom is heavy
    solid = asset.visual
    np.testing.assert_allclose(asset.p_OoOcm_O, solid.center_mass, atol=1e-9)
    expected = solid.moment_inertia / solid.volume
    np.testing.assert_allclose(asset.inertia_per_mass, expected, atol=1e-9)


@settings(max_examples=3)
@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 1e3))
def test_size_and_place_of_the_file_do_not_matter(seed: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    mesh = to_mesh(box((0.06, 0.08, 0.1)))
    other = mesh.copy()
    R = RollPitchYaw(rng.uniform(-3, 3, 3)).ToRotationMatrix().matrix()
    other.vertices = (other.vertices @ R.T) * factor + rng.uniform(-10, 10, 3)
    first, second = (build_asset("b", m, BuildOptions(), {}) for m in (mesh, other))
    # It lies on its largest face in both, turned about z alone.
    assert first.visual.extents[2] == pytest.approx(second.visual.extents[2], rel=1e-6)
    np.testing.assert_allclose(
        np.linalg.eigvalsh(first.inertia_per_mass), np.linalg.eigvalsh(second.inertia_per_mass),
        rtol=1e-5,
    )  # fmt: skip
    assert [p.share for p in first.poses] == pytest.approx([p.share for p in second.poses])


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_the_named_axis_points_up(axis: str) -> None:
    mesh = to_mesh(box((0.06, 0.08, 0.1)))
    asset = build_asset("b", mesh, BuildOptions(up=axis), {})
    share = asset.visual.extents[2] / asset.visual.extents.max()
    assert share == pytest.approx({"x": 0.6, "y": 0.8, "z": 1.0}[axis])


def test_mass_follows_from_density_or_is_given() -> None:
    mesh = to_mesh(box((1.0, 1.0, 1.0)))
    by_density = build_asset("b", mesh, BuildOptions(density=500.0), {})
    side = 0.1 / np.sqrt(3)
    assert by_density.mass == pytest.approx(500 * side**3)
    assert build_asset("b", mesh, BuildOptions(mass=0.3), {}).mass == 0.3


def test_the_diameter_is_kept() -> None:
    mesh = to_mesh(box((1.0, 1.0, 1.0)))
    asset = build_asset("b", mesh, BuildOptions(diameter=0.2), {})
    assert np.linalg.norm(asset.visual.vertices, axis=1).max() == pytest.approx(0.1)


def test_what_cannot_stand_is_refused() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    with pytest.raises(UserError, match=r"'ball' has no stable pose.*allowed"):
        build_asset("ball", ball, BuildOptions(), {})


def test_an_axis_on_which_it_cannot_stand_is_refused_with_those_it_can() -> None:
    can = trimesh.creation.cylinder(radius=0.03, height=0.08, sections=48)
    with pytest.raises(UserError, match=r"cannot stand with x up; it can with -?z, -?z up"):
        build_asset("can", can, BuildOptions(up="x"), {})


def test_poses_on_edges_that_the_walls_above_the_base_take_away_are_left_out() -> None:
    # On a side it lies on its shoulder and on a lip so low that only upright walls are left of it.
    profile = [(-30, 0), (30, 0), (32, 1), (28, 3), (28, 38), (32, 40), (-32, 40), (-28, 38),
               (-28, 3), (-32, 1)]  # fmt: skip
    mesh = to_mesh(prism(profile, 60))
    mesh.vertices = mesh.vertices[:, [0, 2, 1]] * [1, -1, 1]
    asset = build_asset("lipped", mesh, BuildOptions(up="z"), {})
    assert asset.provenance["poses_left_out"] == 2
    assert all(abs(pose.down[0]) < 0.5 for pose in asset.poses)
    for pose in asset.poses:
        assert pose_support_gap(asset.collision, asset.visual, pose) < MOST_SUPPORT_GAP
