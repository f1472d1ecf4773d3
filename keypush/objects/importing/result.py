"""What importing a mesh file gives."""

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray

Colour = tuple[float, float, float]
"""Red, green, blue, each 0 to 1."""
Vertices = NDArray[np.float64]
"""Positions, (n, 3)."""
Faces = NDArray[np.int64]
"""Indices of three vertices, (m, 3), anticlockwise seen from outside."""


@dataclass(frozen=True)
class ImportedMesh:
    """A mesh file made into a solid, in units and frame of the file."""

    solid: trimesh.Trimesh
    """Closed, faces outwards, positive volume, at most 4000 faces."""
    colour: Colour | None
    """Its main colour, if the file has any."""
    sha256: str
    """Of the file's bytes, hexadecimal."""
    notes: tuple[str, ...]
    """What was done to it, one sentence each."""
