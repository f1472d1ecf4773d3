"""Between trimesh's meshes and manifold3d's solids."""

import numpy as np
import trimesh
from manifold3d import Manifold, Mesh64


def to_manifold(mesh: trimesh.Trimesh) -> Manifold:
    """Returns the solid of a closed mesh; its `status` says whether it is one."""
    # Copies, since manifold3d takes no array that is read-only.
    vertices = np.array(mesh.vertices, dtype=np.float64, order="C")
    return Manifold(Mesh64(vertices, np.array(mesh.faces, dtype=np.uint64, order="C")))


def to_mesh(solid: Manifold) -> trimesh.Trimesh:
    """Returns a solid as a closed mesh whose faces are anticlockwise seen from outside."""
    mesh = solid.to_mesh64()
    return trimesh.Trimesh(
        np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts), process=False
    )
