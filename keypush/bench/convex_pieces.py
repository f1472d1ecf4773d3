"""Convex pieces of any object, for engines that collide nothing else."""

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from keypush.bench.development_package import import_development
from keypush.objects.model import ObjectModel

Array = NDArray[np.float64]

_CONVEX = 0.999
"""Share of its hull's volume that a convex shape fills at least."""
_CONCAVITY = 0.05
"""How concave a piece may be by CoACD's measure, relative to half the object's longest side."""
_SEARCH = {"mcts_iterations": 40, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 1000}
"""How hard CoACD looks for the best cuts: a third of the time that its defaults take, and as many
pieces."""


def convex_pieces(model: ObjectModel) -> list[Array]:
    """Returns pieces whose convex hulls together are the object.

    A convex object is one piece. CoACD cuts the others, which takes up to 5 s and is done once
    for every mesh in a process; the pieces follow from the mesh alone.
    Source: Wei et al., "Approximate Convex Decomposition for 3D Meshes with Collision-Aware
    Concavity and Tree Search", 2022.

    Returns:
        Corners (n, 3) in O of every piece.

    Raises:
        UserError: CoACD is not installed.
    """
    coacd = import_development("coacd")
    hull = ConvexHull(model.vertices)
    if model.mesh.volume >= _CONVEX * hull.volume:
        return [model.vertices[hull.vertices]]
    pieces = _cut(coacd, model.vertices.tobytes(), model.faces.tobytes())
    return [piece.copy() for piece in pieces]


@functools.cache
def _cut(coacd: Any, vertices: bytes, faces: bytes) -> list[Array]:
    """Cuts a mesh of vertices (v, 3), float64, and faces (f, 3), int64, given as bytes."""
    coacd.set_log_level("error")
    mesh = coacd.Mesh(
        np.frombuffer(vertices).reshape(-1, 3), np.frombuffer(faces, np.int64).reshape(-1, 3)
    )
    # No preprocessing: the mesh is closed as it is, and remeshed it would not stand as it does.
    pieces = coacd.run_coacd(mesh, threshold=_CONCAVITY, preprocess_mode="off", seed=0, **_SEARCH)
    return [np.asarray(corners) for corners, _ in pieces]
