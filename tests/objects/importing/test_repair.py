"""From faces in any condition to one closed solid."""

from pathlib import Path
from typing import Protocol

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import Error

from keypush.objects.importing.process import Importer
from keypush.objects.importing.result import ImportedMesh
from keypush.objects.importing.steps import import_steps
from keypush.objects.manifolds import to_manifold
from tests.objects.importing.mutate import cup, export

Mesh = trimesh.Trimesh


class Run(Protocol):
    """Imports a mesh by way of a file and checks what every solid must be."""

    def __call__(self, mesh: Mesh, form: str = "ply") -> ImportedMesh: ...


def box(*shift: float) -> Mesh:
    mesh: Mesh = trimesh.creation.box()
    mesh.apply_translation(shift or (0.0, 0.0, 0.0))
    return mesh


def joined(*meshes: Mesh) -> Mesh:
    whole = trimesh.util.concatenate(list(meshes))
    assert isinstance(whole, Mesh)
    return whole


def changed(faces: np.ndarray) -> Mesh:
    return Mesh(trimesh.creation.box().vertices, faces, process=False)


def bowl() -> Mesh:
    mesh: Mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.update_faces(mesh.triangles_center[:, 2] < 0)
    return mesh


@pytest.fixture
def imported(importer: Importer, tmp_path: Path) -> Run:
    def run(mesh: Mesh, form: str = "ply") -> ImportedMesh:
        result = importer.import_mesh(export(mesh, tmp_path / "thing", form))
        solid = to_manifold(result.solid)
        assert solid.status() == Error.NoError
        assert solid.volume() > 0
        assert result.solid.is_watertight
        assert result.solid.volume == pytest.approx(solid.volume())
        assert len(result.solid.faces) <= 4000
        return result

    return run


FACES = trimesh.creation.box().faces
NORMALS = trimesh.creation.box().face_normals


@pytest.mark.parametrize("form", ["ply", "stl"])
@pytest.mark.parametrize(
    ("mesh", "volume", "note"),
    [
        (box(), 1.0, ""),
        (joined(box(), box(0.5, 0.5, 0.5)), 2.0 - 0.125, ""),
        (joined(box(), box(1.0, 0.0, 0.0)), 2.0, ""),
        (joined(box(), box(1.0, 1.0, 0.0)), 2.0, ""),
        (joined(box(), box(3.0, 0.0, 0.0)), 2.0, ""),
        (changed(FACES[NORMALS[:, 2] < 0.5]), 1.0, "holes closed: 1"),
        (changed(FACES[1:]), 1.0, "holes closed: 1"),
        (changed(FACES[:, ::-1]), 1.0, "turned all faces outwards"),
        (joined(box(), changed(FACES[:, ::-1]).apply_translation([3, 0, 0])), 2.0,
         "pieces that faced inwards turned, cavities filled: 1"),
        (joined(box(), changed(FACES[:, ::-1]).apply_scale(0.5)), 1.0,
         "pieces that faced inwards turned, cavities filled: 1"),
        (changed(np.vstack([FACES[::3, ::-1], FACES[1::3], FACES[2::3]])), 1.0, ""),
        (changed(np.vstack([FACES, FACES[:5]])), 1.0, "faces there twice, one dropped: 5"),
        (changed(np.vstack([FACES, FACES[:, ::-1]])), 1.0,
         "faces there with both sides, one dropped: 12"),
        (changed(np.vstack([FACES, FACES[:5, [0, 0, 1]]])), 1.0, "faces without area dropped: 5"),
    ],
    ids=["box", "overlapping", "sharing a face", "sharing an edge", "apart", "a side missing",
         "a face missing", "inverted", "a part inverted", "a cavity",
         "some turned", "some twice", "both sides", "collapsed"],
)  # fmt: skip
def test_the_volume_is_right(
    imported: Run, mesh: Mesh, volume: float, note: str, form: str
) -> None:
    result = imported(mesh, form)
    assert result.solid.volume == pytest.approx(volume, rel=1e-6)
    np.testing.assert_allclose(result.solid.bounds, mesh.bounds, atol=1e-6)
    assert note in " ".join(result.notes)


def test_a_wall_inside_does_not_matter(imported: Run) -> None:
    wall = Mesh([[0.5, y, z] for y, z in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]],
                [[0, 1, 2], [0, 2, 3]])  # fmt: skip
    result = imported(joined(box(), box(1.0, 0.0, 0.0), wall))
    assert result.solid.volume == pytest.approx(2.0)


def test_a_torus_keeps_its_hole_and_a_cup_its_inside(imported: Run) -> None:
    torus = trimesh.creation.torus(1.0, 0.3)
    assert imported(torus).solid.euler_number == 0
    assert imported(torus).solid.volume == pytest.approx(torus.volume)
    walled = cup(thickness=0.08)
    assert imported(walled).solid.volume == pytest.approx(walled.volume)
    assert imported(walled).solid.volume < 0.4 * walled.convex_hull.volume


def test_a_tall_cup_of_one_surface_is_filled(imported: Run) -> None:
    """Its mouth is no larger than a side that a scan left out."""
    single = cup()
    result = imported(single)
    assert "holes closed: 1" in result.notes
    assert result.solid.volume == pytest.approx(single.convex_hull.volume, rel=1e-6)


@pytest.mark.parametrize("mesh", [bowl(), cup(height=0.5)], ids=["bowl", "low cup"])
def test_a_bowl_of_one_surface_gets_walls(imported: Run, mesh: Mesh) -> None:
    result = imported(mesh)
    assert "100% of the surface cannot be closed: gave it walls 3 % of its size thick" in (
        result.notes
    )
    assert 0.03 < result.solid.volume / mesh.convex_hull.volume < 0.4
    # Beyond the surface by 3/4 of a cell of 1/48, and somewhat less after decimation.
    beyond = np.abs(result.solid.bounds - mesh.bounds) / mesh.extents.max()
    assert beyond.max() < 0.02
    assert len(result.solid.split()) == 1


def test_a_strip_with_one_side_gets_walls(imported: Run) -> None:
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    rows = []
    for side in (-0.4, 0.4):
        radius = 1 + side * np.cos(angle / 2)
        rows.append(
            np.column_stack(
                [radius * np.cos(angle), radius * np.sin(angle), side * np.sin(angle / 2)]
            )
        )
    vertices = np.vstack(rows)
    faces = []
    for k in range(60):
        a, b = k, 60 + k
        # After one turn the two sides have changed places.
        c, d = (k + 1, 61 + k) if k < 59 else (60, 0)
        faces += [[a, c, d], [a, d, b]]
    result = imported(Mesh(vertices, faces, process=False))
    assert any("cannot be closed" in note for note in result.notes)


def test_specks_are_dropped(imported: Run) -> None:
    speck = box()
    speck.apply_scale(0.001)
    speck.apply_translation([0.8, 0.0, 0.0])
    result = imported(joined(box(), speck))
    assert result.notes == ("pieces smaller than 1 % of the whole dropped: 1",)
    assert result.solid.volume == pytest.approx(1.0)


def test_cracks_of_rounding_errors_are_closed(imported: Run) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    corners = ball.triangles.reshape(-1, 3)
    corners = corners + 2e-7 * np.random.default_rng(0).normal(size=corners.shape)
    result = imported(Mesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False))
    assert result.solid.volume == pytest.approx(ball.volume, rel=1e-3)


def test_many_faces_become_few(imported: Run) -> None:
    ball = trimesh.creation.icosphere(subdivisions=6)
    result = imported(ball)
    assert result.solid.volume == pytest.approx(ball.volume, rel=0.01)
    assert result.notes[0] == "reduced the surface from 81920 to 20000 faces"


def test_the_same_file_gives_the_same_solid(imported: Run) -> None:
    first, second = imported(bowl()), imported(bowl())
    np.testing.assert_array_equal(first.solid.vertices, second.solid.vertices)
    np.testing.assert_array_equal(first.solid.faces, second.solid.faces)


def shares(mesh: Mesh, folder: Path) -> tuple[float, float]:
    """Returns the volume of the solid and of its hull."""
    mesh.export(folder / "thing.ply")
    result = list(import_steps(folder / "thing.ply"))[-1].result
    return float(result.solid.volume), float(result.solid.convex_hull.volume)


@settings(max_examples=30)
@given(
    st.sampled_from(["cup", "torus", "half box", "overlapping"]),
    st.floats(-3, 3),
    st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1)),
)
def test_size_and_pose_change_nothing(
    tmp_path_factory: pytest.TempPathFactory,
    kind: str,
    exponent: float,
    turn: tuple[float, float, float],
) -> None:
    folder = tmp_path_factory.mktemp("pose")
    mesh = {
        "cup": cup(),
        "torus": trimesh.creation.torus(1.0, 0.3),
        "half box": changed(FACES[NORMALS[:, 2] < 0.5]),
        "overlapping": joined(box(), box(0.5, 0.5, 0.5)),
    }[kind]
    volume, hull = shares(mesh, folder)
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(np.array(turn)))
    mesh.apply_scale(10.0**exponent)
    moved, moved_hull = shares(mesh, folder)
    assert moved == pytest.approx(volume * 1000.0**exponent, rel=1e-3)
    assert moved / moved_hull == pytest.approx(volume / hull, rel=1e-3)
