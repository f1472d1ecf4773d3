"""Fine faces where an object rests.

Drake integrates hydroelastic pressure with one point per contact polygon, its centroid. A base
of few large faces therefore supports less than its outline says: a box on two triangles tips
untouched. A narrow rim of faces along the outline restores the true support polygon.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RIM_WIDTH = 0.0008
"""Width in m of the faces along the outline of a base."""
SIDE_SPACING = 0.02
"""Longest distance in m between two points along a straight edge of an outline."""


def refine_outline(corners: Array, rim: float, spacing: float) -> Array:
    """Adds points to a polygon: two beside each corner, others evenly along its edges.

    The pair beside a corner keeps the rim's faces small there, so that the support
    polygon keeps its corners too.

    Args:
        corners: (k, 2) polygon, anticlockwise.
        rim: width of the rim; the pair stands 2 rim away from the corner.
        spacing: longest distance between two points away from the corners.
    """
    points: list[Array] = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        length = float(np.linalg.norm(end - start))
        inner = length - 4 * rim
        count = max(1, int(np.ceil(inner / spacing)))
        along = [0.0, *(2 * rim + inner * np.arange(count + 1) / count)]
        points += [start + (end - start) * s / length for s in along]
    return np.array(points)


def inset(outline: Array, distance: float) -> Array:
    """Moves every edge of an anticlockwise (n, 2) polygon inwards by `distance`."""
    edge = np.roll(outline, -1, axis=0) - outline
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    after = np.column_stack([-edge[:, 1], edge[:, 0]])
    before = np.roll(after, 1, axis=0)
    cosine = np.sum(before * after, axis=1, keepdims=True)
    return np.asarray(outline + distance * (before + after) / (1 + cosine))


def base_loops(outline: Array, height: float, rim: float) -> list[Array]:
    """Returns the inner and outer loop of a flat base's rim.

    Args:
        outline: (n, 2) polygon about the origin, from which all of it must be visible.
        height: z of the base.
        rim: width of the outermost faces.

    Returns:
        Two loops of shape (n, 3).
    """
    # No rings further in: the fan's centroids lie at 2/3 of the way to the rim, where a round
    # base under even pressure has its friction torque, and more faces made nothing better.
    return [at_height(inset(outline, rim), height), at_height(outline, height)]


def at_height(loop: Array, height: float) -> Array:
    """Lifts an (n, 2) loop to the plane z = height."""
    return np.column_stack([loop, np.full(len(loop), height)])
