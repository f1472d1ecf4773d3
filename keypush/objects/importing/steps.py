"""What importing does with one file, in the order in which results become available."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from manifold3d import Manifold

from keypush.errors import UserError
from keypush.objects.importing.clean import Cleaned, clean
from keypush.objects.importing.frame import UnitFrame, check_thickness
from keypush.objects.importing.manifolds import arrays, as_mesh
from keypush.objects.importing.read import MeshFile, read_mesh
from keypush.objects.importing.repair import Repaired, convex_hull, repair
from keypush.objects.importing.result import ImportedMesh, Vertices
from keypush.objects.importing.topology import signed_volume

_NORMALS = 2000


@dataclass(frozen=True)
class Draft:
    """The convex hull of what a file holds: good if repairing takes too long or fails."""

    result: ImportedMesh


@dataclass(frozen=True)
class Done:
    """A file is imported."""

    result: ImportedMesh


def import_steps(path: Path) -> Iterator[Draft | Done]:
    """Reads a file and makes a solid of it: first a draft, then the result.

    Raises:
        UserError: the file is refused.
        Exception: whatever a library raises about contents that are no mesh.
    """
    file = read_mesh(path)
    frame = UnitFrame.around(path, np.asarray(file.mesh.vertices))
    surface = clean(frame.enter(np.asarray(file.mesh.vertices)), np.asarray(file.mesh.faces))
    if not len(surface.faces):
        raise UserError(f"{path}: all its faces are lines or points; expected a mesh of triangles")
    hull = convex_hull(surface.vertices)
    check_thickness(path, frame, _directions(hull))
    share = abs(signed_volume(surface.vertices, surface.faces)) / hull.volume()
    note = f"the solid is the convex hull, of which the surface fills about {min(share, 1):.0%}"
    yield Draft(_result(file, frame, surface, Repaired(hull, [note])))
    yield Done(_result(file, frame, surface, repair(surface)))


def _directions(hull: Manifold) -> tuple[Vertices, Vertices]:
    """Returns the vertices of a hull and the normals of its largest faces."""
    vertices, faces = arrays(hull)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    largest = np.argsort(-lengths, kind="stable")[:_NORMALS]
    largest = largest[lengths[largest] > 0]
    return vertices, normals[largest] / lengths[largest, None]


def _result(file: MeshFile, frame: UnitFrame, surface: Cleaned, repaired: Repaired) -> ImportedMesh:
    vertices, faces = arrays(repaired.solid)
    return ImportedMesh(
        as_mesh(frame.leave(vertices), faces),
        file.colour,
        file.sha256,
        (*surface.notes, *repaired.notes),
    )
