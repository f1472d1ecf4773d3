"""Stable poses against what is known of simple solids."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RollPitchYaw

from keypush.objects.resting import edge_distance, find_resting_poses, upright_rotation


def test_a_box_rests_on_its_six_faces() -> None:
    size = np.array([0.06, 0.08, 0.10])
    poses = find_resting_poses(trimesh.creation.box(size), np.zeros(3))
    assert len(poses) == 6
    assert sum(pose.share for pose in poses) == pytest.approx(1.0)
    for pose in poses:
        axis = int(np.argmax(np.abs(pose.down)))
        others = np.delete(size, axis)
        assert pose.height == pytest.approx(size[axis] / 2)
        assert pose.tipping_angle == pytest.approx(np.arctan(others.min() / size[axis]))
        np.testing.assert_allclose(pose.R_WO.matrix() @ pose.down, [0, 0, -1], atol=1e-12)
    shares = [pose.share for pose in poses]
    assert shares == sorted(shares, reverse=True)


def test_shares_of_a_cube_are_equal() -> None:
    poses = find_resting_poses(trimesh.creation.box((0.1, 0.1, 0.1)), np.zeros(3))
    np.testing.assert_allclose([pose.share for pose in poses], 1 / 6)


def test_a_sphere_cannot_rest() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.05)
    assert find_resting_poses(ball, np.zeros(3)) == []


def test_a_cylinder_rests_on_its_ends_alone() -> None:
    can = trimesh.creation.cylinder(radius=0.03, height=0.08, sections=32)
    poses = find_resting_poses(can, np.zeros(3))
    assert sorted(float(pose.down[2]) for pose in poses) == pytest.approx([-1.0, 1.0])


def test_a_centre_of_mass_beyond_the_base_makes_it_tip() -> None:
    box = trimesh.creation.box((0.04, 0.04, 0.10))
    downs = [pose.down[2] for pose in find_resting_poses(box, np.array([0.019, 0.0, 0.0]))]
    assert max(np.abs(downs)) < 0.5  # neither end


@given(st.integers(0, 2**32 - 1))
def test_poses_turn_with_the_solid(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = trimesh.creation.box((0.05, 0.07, 0.1))
    com = rng.uniform(-0.01, 0.01, 3)
    R = RollPitchYaw(rng.uniform(-3, 3, 3)).ToRotationMatrix().matrix()
    turned = trimesh.Trimesh(solid.vertices @ R.T, solid.faces, process=False)
    first, second = find_resting_poses(solid, com), find_resting_poses(turned, R @ com)
    assert len(first) == len(second)
    np.testing.assert_allclose([p.share for p in first], [p.share for p in second], atol=1e-6)
    for a, b in zip(first, second, strict=True):
        np.testing.assert_allclose(R @ a.down, b.down, atol=1e-6)


@given(st.integers(0, 2**32 - 1))
def test_upright_rotation_turns_down_to_minus_z_by_the_least_angle(seed: int) -> None:
    down = np.random.default_rng(seed).normal(size=3)
    down /= np.linalg.norm(down)
    R = upright_rotation(down)
    np.testing.assert_allclose(R.matrix() @ down, [0, 0, -1], atol=1e-9)
    assert R.ToAngleAxis().angle() == pytest.approx(np.arccos(np.clip(-down[2], -1, 1)), abs=1e-6)


@pytest.mark.parametrize("down", [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
def test_upright_rotation_of_the_poles(down: list[float]) -> None:
    turned = upright_rotation(np.array(down)).matrix() @ down
    np.testing.assert_allclose(turned, [0, 0, -1], atol=1e-12)


def test_edge_distance_of_a_square() -> None:
    square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])
    assert edge_distance(square, np.array([1.0, 0.3])) == pytest.approx(0.3)
    assert edge_distance(square, np.array([3.0, 1.0])) == pytest.approx(-1.0)
