"""Closed solids that the tests of meshing share."""

import itertools

import numpy as np
import trimesh
from manifold3d import Manifold

from keypush.objects.generators import solids
from keypush.objects.generators.solids import above_ground, box, ellipsoid, lathe, prism
from keypush.objects.manifolds import to_mesh

STAR = [
    (radius * np.cos(angle), radius * np.sin(angle))
    for k in range(10)
    for radius, angle in [((0.05, 0.02)[k % 2], np.pi * k / 5)]
]


def named_solids() -> dict[str, trimesh.Trimesh]:
    """Solids of every kind of base: corners, round, ring, feet, concave, curved sides."""
    cup = lathe(
        [(0.0, 0.0), (0.03, 0.0), (0.03, 0.06), (0.026, 0.06), (0.026, 0.004), (0.0, 0.004)]
    )
    table = box((0.08, 0.06, 0.01), (0.0, 0.0, 0.03))
    for x in (-0.03, 0.03):
        for y in (-0.02, 0.02):
            table = table + box((0.01, 0.01, 0.031), (x, y, 0.0))
    ring = lathe([(0.03, 0.0), (0.045, 0.0), (0.045, 0.02), (0.03, 0.02)], 32)
    stone = above_ground(ellipsoid((0.045, 0.035, 0.03), (0.0, 0.0, 0.02), 40))
    shapes = {
        "box": box((0.08, 0.05, 0.03)),
        "cup": cup,
        "table": table,
        "ring": ring,
        "star": prism(STAR, 0.03),
        "stone": stone,
        "bevelled": bevelled_box((0.07, 0.06, 0.04), 6e-4),
        "soft_box": solids.soft_box((0.07, 0.05, 0.04), 0.004),
    }
    return {name: to_mesh(solid) for name, solid in shapes.items()}


def bevelled_box(size: tuple[float, float, float], bevel: float) -> Manifold:
    """A box whose edges are cut off at 45 degrees."""
    half = np.array(size) / 2
    corners = [
        np.where(np.arange(3) == axis, half, half - bevel) * signs
        for axis in range(3)
        for signs in itertools.product((-1, 1), repeat=3)
    ]
    return Manifold.hull_points(np.array(corners))
