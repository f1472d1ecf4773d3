"""Convex pieces of the catalogue's shapes, for engines that collide nothing else."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from keypush.errors import UserError
from keypush.objects.basic_shapes import SEGMENTS
from keypush.objects.model import ObjectModel

Array = NDArray[np.float64]

_CONVEX = 0.999
"""Share of its hull's volume that a convex shape fills at least."""
_WALL_PIECES = 8
"""Pieces around the wall of a mug."""
_FLAT = 1e-6
"""Coordinates closer than this are the same, m."""


def convex_pieces(model: ObjectModel) -> list[Array]:
    """Returns pieces whose convex hulls together are the object.

    Returns:
        Corners (n, 3) in O of every piece.

    Raises:
        UserError: the shape is not convex and nobody has said how to divide it.
    """
    divide = {"bottle": _bottle, "l_block": _l_block, "mug": _mug}.get(model.name)
    if divide is not None:
        return [piece[ConvexHull(piece).vertices] for piece in divide(model.vertices)]
    hull = ConvexHull(model.vertices)
    if model.mesh.volume < _CONVEX * hull.volume:
        raise UserError(
            f"object {model.name!r} has no convex pieces for MuJoCo; "
            "allowed: convex shapes, bottle, l_block, mug"
        )
    return [model.vertices[hull.vertices]]


def _bottle(vertices: Array) -> list[Array]:
    """Body with shoulder, and neck."""
    z = vertices[:, 2]
    neck = np.unique(np.round(z / _FLAT))[-2] * _FLAT
    return [vertices[z < neck + _FLAT], vertices[z > neck - _FLAT]]


def _l_block(vertices: Array) -> list[Array]:
    """The arm along x, and what the arm along y has beyond it."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    x_split = vertices[vertices[:, 1] > high[1] - _FLAT, 0].max()
    y_split = vertices[vertices[:, 0] > high[0] - _FLAT, 1].max()
    return [
        _box(low, np.array([high[0], y_split, high[2]])),
        _box(np.array([low[0], y_split, low[2]]), np.array([x_split, high[1], high[2]])),
    ]


def _box(low: Array, high: Array) -> Array:
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    return np.asarray(low + corners * (high - low))


def _mug(vertices: Array) -> list[Array]:
    """Sectors of the wall, the bottom, and the three sides of the handle.

    The mesh has its loops first, then the two centres of its ends, then the eight elbows
    of the handle: four of its lower side and four of its upper one.
    """
    elbows = vertices[-8:]
    loops = vertices[:-10].reshape(-1, SEGMENTS, 3)
    roots = elbows.copy()
    roots[:, 0] = loops[:, :, 0].max()
    handle = [
        np.vstack([roots[:4], elbows[:4]]),
        elbows,
        np.vstack([roots[4:], elbows[4:]]),
    ]
    inside = loops[-1, 0, 2]
    # The wall stands on the bottom, so that the table is touched by one piece alone.
    wall = loops.copy()
    wall[:, :, 2] = np.maximum(wall[:, :, 2], inside)
    each = SEGMENTS // _WALL_PIECES
    sectors = [
        wall[:, np.arange(start, start + each + 1) % SEGMENTS].reshape(-1, 3)
        for start in range(0, SEGMENTS, each)
    ]
    low = loops[:, 0, 2] < inside + _FLAT
    bottom = np.vstack([loops[low].reshape(-1, 3), wall[low].reshape(-1, 3)])
    return [*sectors, bottom, *handle]
