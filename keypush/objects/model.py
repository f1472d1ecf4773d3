"""`ObjectModel`: one object at one size and mass."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import trimesh
from numpy.typing import NDArray
from pydrake.math import RotationMatrix

from keypush.objects.asset import ObjectAsset
from keypush.objects.resting import support_polygon

BASE_TOLERANCE = 1e-6
"""Vertices within this distance in m of the lowest one belong to the base."""


@dataclass(frozen=True, eq=False)
class ObjectModel:
    """An object in its own frame O: upright, z up, Oo in the centre of its bounding box."""

    name: str
    """Of a built-in object, or of one that the user has added."""
    size_ratio: float
    """Size relative to the object's own."""
    mesh: trimesh.Trimesh
    """Closed mesh in O that touches; treat it as read-only."""
    visual: trimesh.Trimesh
    """Mesh in O that is seen; likewise."""
    p_OP: NDArray[np.float64]
    """Points drawn uniformly by area over the whole of `visual`, (`SURFACE_POINTS`, 3)."""
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
        """Vertices of what touches, in O, (v, 3)."""
        return np.asarray(self.mesh.vertices, dtype=float)

    @property
    def faces(self) -> NDArray[np.int64]:
        """Triangles of what touches, (f, 3), anticlockwise seen from outside."""
        return np.asarray(self.mesh.faces, dtype=np.int64)

    @cached_property
    def rest_height(self) -> float:
        """Height of Oo above the table when the object stands, m."""
        return float(-self.vertices[:, 2].min())

    @cached_property
    def bounding_radius(self) -> float:
        """Radius about Oo of the sphere that holds the object, m."""
        return float(np.linalg.norm(self.visual.vertices, axis=1).max())

    @cached_property
    def support_polygon(self) -> NDArray[np.float64]:
        """Convex hull of the base in Oxy, (k, 2), anticlockwise."""
        return support_polygon(self.vertices, RotationMatrix(), BASE_TOLERANCE)

    @cached_property
    def reference_points(self) -> NDArray[np.float64]:
        """Corners of the bounding box in O, (8, 3), for the upright test."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
        return np.asarray(low + corners * (high - low))

    def surface_points(self, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
        """Draws some of the points on the surface, each at most once.

        Args:
            count: at most `SURFACE_POINTS`.
            rng: source of the draw.

        Returns:
            (count, 3) points in O.
        """
        return self.p_OP[rng.choice(len(self.p_OP), size=count, replace=False)]


def scaled_model(asset: ObjectAsset, size_ratio: float, mass: float | None = None) -> ObjectModel:
    """Makes the model of an asset at a size, with uniform density.

    Args:
        asset: object at size ratio 1.
        size_ratio: factor on all lengths.
        mass: kg; None: the asset's own.
    """
    mass = asset.mass if mass is None else mass
    return ObjectModel(
        name=asset.name,
        size_ratio=size_ratio,
        mesh=_scaled(asset.collision, size_ratio),
        visual=_scaled(asset.visual, size_ratio),
        p_OP=asset.surface_samples * size_ratio,
        mass=mass,
        p_OoOcm_O=asset.p_OoOcm_O * size_ratio,
        I_OOcm_O=asset.inertia_per_mass * (mass * size_ratio**2),
        colour=(*asset.colour, 1.0),
    )


def _scaled(mesh: trimesh.Trimesh, factor: float) -> trimesh.Trimesh:
    return trimesh.Trimesh(np.asarray(mesh.vertices) * factor, mesh.faces, process=False)
