"""Collapsing and splitting edges keeps a surface closed."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from keypush.objects.meshing.surface import FREE, Surface


def sphere() -> Surface:
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=1.0)
    return Surface(mesh, np.full(len(mesh.faces), FREE))


@given(st.integers(0, 2**32 - 1))
def test_random_collapses_and_splits_keep_it_closed(seed: int) -> None:
    rng, surface = np.random.default_rng(seed), sphere()
    for _ in range(60):
        edges = list(surface.edges())
        u, v = edges[rng.integers(len(edges))]
        middle = (surface.points[u] + surface.points[v]) / 2
        if rng.random() < 0.3:
            surface.split(u, v, middle)
        elif surface.can_collapse(u, v, middle):
            surface.collapse(u, v, middle)
    mesh = surface.to_mesh()
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.euler_number == 2
    assert mesh.volume > 0


def test_a_split_changes_no_shape_and_keeps_labels() -> None:
    mesh = trimesh.creation.box((1.0, 2.0, 3.0))
    surface = Surface(mesh, np.arange(len(mesh.faces)))
    u, v = next(surface.edges())
    labels = {surface.labels[f] for f in surface.around[u] & surface.around[v]}
    middle = surface.split(u, v, (surface.points[u] + surface.points[v]) / 2)
    assert {surface.labels[f] for f in surface.around[middle]} == labels
    assert len(surface.faces) == len(mesh.faces) + 2
    assert surface.to_mesh().volume == pytest.approx(6.0)
    assert surface.to_mesh().area == pytest.approx(mesh.area)


def test_an_edge_of_a_tetrahedron_cannot_collapse() -> None:
    mesh = trimesh.Trimesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    )
    surface = Surface(mesh, np.full(4, FREE))
    assert not any(surface.can_collapse(u, v, surface.points[v]) for u, v in surface.edges())


def test_a_collapse_that_folds_the_surface_is_refused() -> None:
    surface = sphere()
    u, v = next(surface.edges())
    assert surface.can_collapse(u, v, surface.points[v])
    assert not surface.can_collapse(u, v, -surface.points[v])
