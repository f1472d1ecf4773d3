"""Builders of closed meshes: prisms, solids of revolution, and a handle."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import trimesh
from numpy.typing import NDArray

from keypush.objects.refine import (
    RIM_WIDTH,
    SIDE_SPACING,
    Array,
    at_height,
    base_loops,
    refine_outline,
)

PUSHED_HEIGHTS = (0.015, 0.03)
"""Heights in m above the base between which a finger pushes: rows of faces begin here."""


def stitch(first: NDArray[np.int64], second: NDArray[np.int64]) -> list[list[int]]:
    """Returns the triangles between two loops of n vertex indices each.

    They face outwards when the loops run anticlockwise seen from the second loop's side.
    """
    faces = []
    for a, b, c, d in zip(first, np.roll(first, -1), np.roll(second, -1), second, strict=True):
        faces += [[a, b, c], [a, c, d]]
    return faces


def loft(loops: Sequence[Array]) -> trimesh.Trimesh:
    """Joins loops of n points, (n, 3) each, and closes both ends with a fan about the z axis.

    The first loop is the innermost of the base, the last the innermost of the top.
    """
    n = len(loops[0])
    ends = [[0.0, 0.0, loops[0][0, 2]], [0.0, 0.0, loops[-1][0, 2]]]
    vertices = np.vstack([*loops, ends])
    indices = np.arange(len(loops) * n).reshape(-1, n)
    faces = [face for lower, upper in pairwise(indices) for face in stitch(lower, upper)]
    bottom, top = len(vertices) - 2, len(vertices) - 1
    faces += [[bottom, b, a] for a, b in zip(indices[0], np.roll(indices[0], -1), strict=True)]
    faces += [[a, b, top] for a, b in zip(indices[-1], np.roll(indices[-1], -1), strict=True)]
    return trimesh.Trimesh(vertices, faces, process=False)


def prism(corners: Sequence[tuple[float, float]], height: float) -> trimesh.Trimesh:
    """Builds an upright prism.

    Args:
        corners: polygon in m, anticlockwise, all of it visible from (0, 0).
        height: extent along z in m.
    """
    outline = refine_outline(np.array(corners, dtype=float), RIM_WIDTH, SIDE_SPACING)
    loops = base_loops(outline, 0.0, RIM_WIDTH)
    loops += [at_height(outline, z) for z in _rows([0.0, height]) if z > 0]
    return loft(loops)


def lathe(profile: Sequence[tuple[float, float]], segments: int) -> trimesh.Trimesh:
    """Builds a solid of revolution about z with a flat base.

    Args:
        profile: (radius, height) in m from the rim of the base to the last ring, which
            a flat face closes; begins at height 0.
        segments: corners of its cross section; one of its sides faces +x.
    """
    angle = 2 * np.pi * (np.arange(segments) - 0.5) / segments
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    loops = base_loops(profile[0][0] * circle, 0.0, RIM_WIDTH)
    loops += [at_height(radius * circle, z) for radius, z in profile[1:]]
    return loft(loops)


def straight_wall(radius: float, bottom: float, top: float) -> list[tuple[float, float]]:
    """Returns a profile of constant radius with rows where a finger pushes."""
    return [(radius, z) for z in _rows([bottom, top])]


def add_handle(
    mesh: trimesh.Trimesh, lower: Sequence[int], upper: Sequence[int], reach: float
) -> trimesh.Trimesh:
    """Replaces two quadrilaterals of a wall that faces +x by the ends of a square tube.

    Args:
        mesh: closed mesh.
        lower: the four vertices of the lower one, anticlockwise from outside, from the
            lower -y corner.
        upper: likewise of the upper one.
        reach: distance in m from the wall to the outside of the tube.
    """
    vertices = np.asarray(mesh.vertices)
    low, high = vertices[list(lower)], vertices[list(upper)]
    outer = np.array([reach, 0.0, 0.0])
    inner = outer * (1 - (low[3, 2] - low[0, 2]) / reach)
    elbows = np.vstack([low[:2] + outer, low[2:] + inner, high[[3, 2]] + outer,
                        high[[1, 0]] + inner])  # fmt: skip
    first = len(vertices)
    rings = [np.array(lower), first + np.arange(4), first + 4 + np.arange(4),
             np.array(upper)[[3, 2, 1, 0]]]  # fmt: skip
    closed = np.array([set(face) <= set(lower) or set(face) <= set(upper)
                       for face in mesh.faces.tolist()])  # fmt: skip
    tube = [face for a, b in pairwise(rings) for face in stitch(a, b)]
    return trimesh.Trimesh(
        np.vstack([vertices, elbows]), np.vstack([mesh.faces[~closed], tube]), process=False
    )


def _rows(ends: list[float]) -> list[float]:
    bottom, top = ends
    # A row must not end up as a sliver just below the top.
    rows = [z for z in PUSHED_HEIGHTS if bottom < z < top - 0.003]
    return [bottom, *rows, top]
