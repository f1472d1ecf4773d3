"""Between meshes and manifold3d, which judges whether a mesh is closed and joins solids."""

from collections.abc import Sequence

import numpy as np
import trimesh
from manifold3d import Error, Manifold, OpType

from keypush.objects.importing.result import Faces, Vertices
from keypush.objects.importing.topology import NO_VOLUME
from keypush.objects.manifolds import to_manifold


def as_solid(vertices: Vertices, faces: Faces) -> Manifold | None:
    """Returns the solid that faces enclose, or None if they are not closed or enclose nothing.

    Pieces that face inwards are turned, pieces that overlap are joined, pieces without an
    inside are left out.
    """
    if len(faces) < 4:
        return None
    whole = to_manifold(as_mesh(vertices, faces))
    if whole.status() != Error.NoError or whole.is_empty():
        return None
    pieces = [_outwards(piece) for piece in whole.decompose()]
    return join([piece for piece in pieces if piece.volume() > NO_VOLUME])


def join(solids: Sequence[Manifold]) -> Manifold | None:
    """Returns the union of solids, or None if there is none."""
    if not solids:
        return None
    whole = solids[0] if len(solids) == 1 else Manifold.batch_boolean(list(solids), OpType.Add)
    good = whole.status() == Error.NoError and whole.volume() > NO_VOLUME
    return whole if good else None


def arrays(solid: Manifold) -> tuple[Vertices, Faces]:
    """Returns the vertices and faces of a solid."""
    mesh = solid.to_mesh64()
    vertices = np.array(mesh.vert_properties, dtype=np.float64)[:, :3]
    return vertices, np.array(mesh.tri_verts, dtype=np.int64)


def as_mesh(vertices: Vertices, faces: Faces) -> trimesh.Trimesh:
    """Returns a mesh of just these vertices and faces."""
    return trimesh.Trimesh(vertices, faces, process=False)


def _outwards(solid: Manifold) -> Manifold:
    if solid.volume() >= 0:
        return solid
    vertices, faces = arrays(solid)
    return to_manifold(as_mesh(vertices, faces[:, ::-1]))
