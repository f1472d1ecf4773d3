"""`ObjectModel`: one object at one size and mass."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from keypush.objects.mass import uniform_density

BASE_TOLERANCE = 1e-6
"""Vertices within this distance in m of the lowest one belong to the base."""


@dataclass(frozen=True, eq=False)
class ObjectModel:
    """An object in its own frame O: upright, z up, Oo in the centre of its bounding box."""

    name: str
    """Catalogue name."""
    size_ratio: float
    """Size relative to the catalogue's."""
    mesh: trimesh.Trimesh
    """Closed mesh in O, for contact, sight and sampling; treat it as read-only."""
    mass: float
    """kg."""
    p_OoOcm_O: NDArray[np.float64]
    """Centre of mass, (3,)."""
    I_OOcm_O: NDArray[np.float64]
    """Inertia about the centre of mass, (3, 3), kg m^2."""
    colour: tuple[float, float, float, float]
    """RGBA in [0, 1]."""

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Mesh vertices in O, (v, 3)."""
        return np.asarray(self.mesh.vertices, dtype=float)

    @property
    def faces(self) -> NDArray[np.int64]:
        """Mesh triangles, (f, 3), anticlockwise seen from outside."""
        return np.asarray(self.mesh.faces, dtype=np.int64)

    @cached_property
    def rest_height(self) -> float:
        """Height of Oo above the table when the object stands, m."""
        return float(-self.vertices[:, 2].min())

    @cached_property
    def bounding_radius(self) -> float:
        """Radius about Oo of the sphere that holds the object, m."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    @cached_property
    def support_polygon(self) -> NDArray[np.float64]:
        """Convex hull of the base in Oxy, (k, 2), anticlockwise."""
        vertices = self.vertices
        base = vertices[vertices[:, 2] < vertices[:, 2].min() + BASE_TOLERANCE, :2]
        return np.asarray(base[ConvexHull(base).vertices])

    @cached_property
    def reference_points(self) -> NDArray[np.float64]:
        """Corners of the bounding box in O, (8, 3), for the upright test."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
        return np.asarray(low + corners * (high - low))

    def surface_points(self, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
        """Draws points uniformly by area over the whole surface.

        Returns:
            (count, 3) points in O.
        """
        triangles = self.vertices[self.faces]
        area = np.asarray(self.mesh.area_faces)
        chosen = triangles[rng.choice(len(area), size=count, p=area / area.sum())]
        # Source: Osada et al., "Shape Distributions", 2002, eq. (1).
        root, share = np.sqrt(rng.random(count)), rng.random(count)
        weights = np.column_stack([1 - root, root * (1 - share), root * share])
        return np.asarray(np.einsum("nk,nkd->nd", weights, chosen))


def model_from_mesh(
    name: str,
    mesh: trimesh.Trimesh,
    *,
    size_ratio: float,
    mass: float,
    colour: tuple[float, float, float, float],
) -> ObjectModel:
    """Makes the model of a mesh that is already in O, with uniform density.

    Raises:
        ValueError: the mesh is not closed.
    """
    com, inertia = uniform_density(mesh, mass)
    return ObjectModel(name, size_ratio, mesh, mass, com, inertia, colour)
