"""Mass properties of closed meshes against those of exact solids."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon

from keypush.objects.mass import uniform_density

SIZES = st.floats(0.01, 0.1)


@given(st.tuples(SIZES, SIZES, SIZES), st.floats(0.01, 10.0))
def test_inertia_of_a_box(size: tuple[float, float, float], mass: float) -> None:
    com, inertia = uniform_density(trimesh.creation.box(size), mass)
    x, y, z = size
    expected = mass / 12 * np.diag([y**2 + z**2, x**2 + z**2, x**2 + y**2])
    np.testing.assert_allclose(inertia, expected, atol=1e-9 * np.trace(expected))
    np.testing.assert_allclose(com, 0.0, atol=1e-12)


@given(st.integers(3, 64), SIZES, SIZES)
def test_inertia_of_a_cylinder_is_that_of_its_regular_polygon(
    sides: int, radius: float, height: float
) -> None:
    """J about the axis of a regular prism: m R^2 / 6 (2 + cos(2 pi / n)), R its circumradius."""
    angle = 2 * np.pi * np.arange(sides) / sides
    corners = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    mesh = trimesh.creation.extrude_polygon(Polygon(corners), height)
    com, inertia = uniform_density(mesh, 0.3)
    axial = 0.3 * radius**2 / 6 * (2 + np.cos(2 * np.pi / sides))
    across = axial / 2 + 0.3 * height**2 / 12
    np.testing.assert_allclose(inertia, np.diag([across, across, axial]), atol=1e-9 * axial)
    np.testing.assert_allclose(com, [0.0, 0.0, height / 2], atol=1e-12)


def test_a_round_cylinder_is_the_limit() -> None:
    mesh = trimesh.creation.cylinder(radius=0.03, height=0.08, sections=512)
    _, inertia = uniform_density(mesh, 0.2)
    axial, across = 0.2 * 0.03**2 / 2, 0.2 * (3 * 0.03**2 + 0.08**2) / 12
    np.testing.assert_allclose(inertia, np.diag([across, across, axial]), rtol=1e-4, atol=1e-12)


def test_the_com_of_an_l_is_that_of_its_two_arms() -> None:
    side, arm = 6.0, 2.5
    corners = [(0, 0), (side, 0), (side, arm), (arm, arm), (arm, side), (0, side)]
    com, _ = uniform_density(trimesh.creation.extrude_polygon(Polygon(corners), 3.5), 0.1)
    areas = np.array([side * arm, (side - arm) * arm])
    x = areas @ np.array([side / 2, arm / 2]) / areas.sum()
    np.testing.assert_allclose(com, [x, x, 1.75], atol=1e-9)


def test_a_hollow_ball_is_a_ball_less_a_ball() -> None:
    outer, inner = (trimesh.creation.icosphere(subdivisions=3, radius=r) for r in (0.05, 0.04))
    mass = outer.volume * 1000.0, inner.volume * 1000.0
    expected = uniform_density(outer, mass[0])[1] - uniform_density(inner, mass[1])[1]
    inner.invert()
    shell = trimesh.Trimesh(
        np.vstack([outer.vertices, inner.vertices]),
        np.vstack([outer.faces, inner.faces + len(outer.vertices)]),
        process=False,
    )
    _, inertia = uniform_density(shell, mass[0] - mass[1])
    np.testing.assert_allclose(inertia, expected, atol=1e-9 * np.trace(expected))


@given(st.floats(-np.pi, np.pi), st.tuples(SIZES, SIZES, SIZES))
def test_it_turns_and_moves_with_the_mesh(angle: float, offset: tuple[float, float, float]) -> None:
    mesh = trimesh.creation.box((0.03, 0.05, 0.08))
    _, inertia = uniform_density(mesh, 0.1)
    X = trimesh.transformations.rotation_matrix(angle, [1.0, 2.0, 3.0])
    X[:3, 3] = offset
    mesh.apply_transform(X)
    com, turned = uniform_density(mesh, 0.1)
    np.testing.assert_allclose(com, offset, atol=1e-9)
    np.testing.assert_allclose(turned, X[:3, :3] @ inertia @ X[:3, :3].T, atol=1e-10)


def test_open_and_inverted_meshes_are_refused() -> None:
    holed = trimesh.creation.box((0.1, 0.1, 0.1))
    holed.update_faces(np.arange(len(holed.faces)) > 0)
    inverted = trimesh.creation.box((0.1, 0.1, 0.1))
    inverted.invert()
    for mesh in (holed, inverted):
        with pytest.raises(ValueError, match="closed mesh whose faces point outwards"):
            uniform_density(mesh, 0.1)
