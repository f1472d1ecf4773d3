"""Faces as index arrays: edges, pieces, and which way faces are turned."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from keypush.objects.importing.result import Faces, Vertices

Indices = NDArray[np.int64]

NO_VOLUME = 1e-9
"""Volume, in a mesh of size 1, below which there is no inside."""


@dataclass(frozen=True)
class Edges:
    """The 3 m sides of m faces; side k belongs to face k % m."""

    ends: Indices
    """(3 m, 2), in the face's direction."""
    edge: Indices
    """(3 m): number of the undirected edge."""
    faces: Indices
    """(e): how many faces meet at each edge."""


def find_edges(faces: Faces) -> Edges:
    """Returns the edges of faces (m, 3)."""
    ends = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    low, high = ends.min(axis=1), ends.max(axis=1)
    key = low * (int(faces.max()) + 1) + high
    _, edge, count = np.unique(key, return_inverse=True, return_counts=True)
    return Edges(ends, edge.reshape(-1), count)


def piece_labels(faces: Faces, count: int) -> Indices:
    """Numbers the pieces that hang together by vertices: (m), from the count of vertices."""
    a, b, c = faces.T
    rows, columns = np.concatenate([a, b]), np.concatenate([b, c])
    return _labels(rows, columns, count)[faces[:, 0]]


def orient(faces: Faces) -> tuple[Faces, Indices, Indices]:
    """Turns faces so that neighbours agree.

    Neighbours are two faces that meet at an edge where no third does. A piece is a set of
    faces joined by such edges; each is turned the way that most of its faces are.

    Args:
        faces: (m, 3).

    Returns:
        faces: (m, 3), some turned.
        pieces: (m), number of each face's piece.
        one_sided: numbers of pieces that cannot be turned, such as a Moebius strip.
    """
    m = len(faces)
    edges = find_edges(faces)
    sides = np.flatnonzero(edges.faces[edges.edge] == 2)
    paired = sides[np.argsort(edges.edge[sides], kind="stable")].reshape(-1, 2)
    first, second = paired[:, 0] % m, paired[:, 1] % m
    agree = edges.ends[paired[:, 0], 0] != edges.ends[paired[:, 1], 0]
    pieces = _labels(first, second, m)
    # Every face stands in a graph twice, as it is and turned; what agrees hangs together.
    turned = np.where(agree, 0, m)
    cover = _labels(
        np.concatenate([first, first + m]),
        np.concatenate([second + turned, second + m - turned]),
        2 * m,
    )
    lowest = np.full(pieces.max() + 1, 2 * m, dtype=np.int64)
    np.minimum.at(lowest, pieces, cover[:m])
    turn = cover[:m] != lowest[pieces]
    mostly = np.bincount(pieces, turn) > np.bincount(pieces) / 2
    turn ^= mostly[pieces]
    one_sided = np.unique(pieces[cover[:m] == cover[m:]])
    return np.where(turn[:, None], faces[:, ::-1], faces), pieces, one_sided


def piece_volumes(vertices: Vertices, faces: Faces) -> Vertices:
    """Returns the signed volumes of the pieces of a closed surface that enclose one."""
    _, pieces = np.unique(piece_labels(faces, len(vertices)), return_inverse=True)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    volumes = np.bincount(pieces.reshape(-1), np.einsum("ij,ij->i", a, np.cross(b, c)) / 6)
    return volumes[np.abs(volumes) > NO_VOLUME]


def signed_volume(vertices: Vertices, faces: Faces) -> float:
    """Returns the volume inside faces that enclose one."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def face_areas(vertices: Vertices, faces: Faces) -> Vertices:
    """Returns areas, (m)."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    areas: Vertices = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return areas


def compact(vertices: Vertices, faces: Faces) -> tuple[Vertices, Faces]:
    """Drops vertices that no face uses."""
    used, renumbered = np.unique(faces, return_inverse=True)
    return vertices[used], renumbered.reshape(-1, 3).astype(np.int64)


def _labels(rows: Indices, columns: Indices, count: int) -> Indices:
    graph = coo_array((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(count, count))
    labels: Indices = connected_components(graph, directed=False)[1].astype(np.int64)
    return labels
