"""A frame in which every mesh has the size 1: tolerances are then plain numbers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from keypush.errors import UserError
from keypush.objects.importing.result import Vertices

_SIZES = (1e-9, 1e9)
_FARTHEST = 1e6
_THINNEST = 0.01


@dataclass(frozen=True)
class UnitFrame:
    """Maps the bounding box of a mesh to one whose diagonal is 1, about the origin."""

    centre: Vertices
    size: float
    """Diagonal of the bounding box, in the file's units."""

    @classmethod
    def around(cls, path: Path, vertices: Vertices) -> Self:
        """Returns the frame of a mesh.

        Args:
            path: named when it is refused.
            vertices: (n, 3), finite.

        Raises:
            UserError: its size cannot be worked with.
        """
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        size = float(np.linalg.norm(high - low))
        if not _SIZES[0] <= size <= _SIZES[1]:
            raise UserError(
                f"{path}: its size is {size:.3g}; allowed: {_SIZES[0]:.0e} to {_SIZES[1]:.0e}"
            )
        away = float(np.abs(vertices).max())
        if away > _FARTHEST * size:
            raise UserError(
                f"{path}: its size is {size:.3g} and it lies {away:.3g} from the origin; "
                f"allowed: at most {_FARTHEST:.0e} times its size"
            )
        return cls((low + high) / 2, size)

    def enter(self, vertices: Vertices) -> Vertices:
        """Takes points from the file's frame into this one."""
        return (vertices - self.centre) / self.size

    def leave(self, vertices: Vertices) -> Vertices:
        """Takes points from this frame into the file's."""
        return vertices * self.size + self.centre


def check_thickness(path: Path, frame: UnitFrame, hull: tuple[Vertices, Vertices]) -> None:
    """Refuses a sheet or a wire.

    Args:
        path: named when it is refused.
        frame: that of the mesh.
        hull: vertices of its convex hull (n, 3) and normals of the largest faces (m, 3), in it.

    Raises:
        UserError: it is thinner than 1 % of its size.
    """
    vertices, normals = hull
    thickness = 0.0
    if len(vertices) >= 4 and len(normals):
        heights = vertices @ normals.T
        thickness = float(np.ptp(heights, axis=0).min())
    if thickness < _THINNEST:
        raise UserError(
            f"{path}: it is flat, {thickness * frame.size:.3g} thick and {frame.size:.3g} across; "
            f"allowed: at least {_THINNEST:.0%} of its size"
        )
