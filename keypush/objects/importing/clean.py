"""Tidies the faces of a mesh: what is double, collapsed or negligible goes."""

from dataclasses import dataclass

import numpy as np

from keypush.objects.importing.decimate import decimate_surface
from keypush.objects.importing.result import Faces, Vertices
from keypush.objects.importing.topology import compact, face_areas, find_edges, piece_labels

_SAME = 1e-9
_CRACK = 1e-5
_SPECK = 0.01
_SPECK_AREA = 0.05


@dataclass(frozen=True)
class Cleaned:
    """A tidy mesh of size 1."""

    vertices: Vertices
    faces: Faces
    notes: list[str]


def clean(vertices: Vertices, faces: Faces) -> Cleaned:
    """Merges vertices, drops faces that add nothing, and decimates a big mesh.

    Args:
        vertices: (n, 3), in a frame where the bounding box has diagonal 1.
        faces: (m, 3).
    """
    notes: list[str] = []
    vertices, faces = _merge_cracks(*_merge(vertices, faces, np.arange(len(vertices)), _SAME))
    vertices, faces = _drop_collapsed(vertices, faces, notes)
    if len(faces):
        vertices, faces = _drop_specks(vertices, faces, notes)
    before = len(faces)
    vertices, faces = decimate_surface(vertices, faces)
    if len(faces) < before:
        notes.append(f"reduced the surface from {before} to {len(faces)} faces")
    return Cleaned(vertices, faces, notes)


def _merge(
    vertices: Vertices, faces: Faces, among: np.ndarray, distance: float
) -> tuple[Vertices, Faces]:
    """Merges some of the vertices where they are nearer than about a distance."""
    target = np.arange(len(vertices))
    cell = np.round(vertices[among] / distance).astype(np.int64)
    _, first, number = np.unique(cell, axis=0, return_index=True, return_inverse=True)
    target[among] = among[first][number.reshape(-1)]
    return compact(vertices, target[faces])


def _merge_cracks(vertices: Vertices, faces: Faces) -> tuple[Vertices, Faces]:
    """Merges vertices of open edges that lie a rounding error apart."""
    for shift in (0.0, 0.5):
        # The second grid has its borders where the first one has its middles.
        edges = find_edges(faces)
        among = np.unique(edges.ends[edges.faces[edges.edge] == 1])
        if len(among) == 0:
            break
        moved, faces = _merge(vertices + shift * _CRACK, faces, among, _CRACK)
        vertices = moved - shift * _CRACK
    return vertices, faces


def _drop_collapsed(vertices: Vertices, faces: Faces, notes: list[str]) -> tuple[Vertices, Faces]:
    """Drops faces with a corner twice, and of those with the same corners all but one."""
    a, b, c = faces.T
    full = faces[(a != b) & (b != c) & (c != a)]
    _count(notes, len(faces) - len(full), "faces without area dropped: {}")
    if not len(full):
        return compact(vertices, full)
    start = full.argmin(axis=1)
    # Beginning with its lowest vertex, a face is the same for the same corners and the same side.
    turned = np.take_along_axis(full, (start[:, None] + np.arange(3)) % 3, axis=1)
    _, kept = np.unique(turned, axis=0, return_index=True)
    _count(notes, len(full) - len(kept), "faces there twice, one dropped: {}")
    return compact(vertices, full[np.sort(kept)])


def _drop_specks(vertices: Vertices, faces: Faces, notes: list[str]) -> tuple[Vertices, Faces]:
    """Drops pieces smaller than 1 % of the whole, unless they are what it is made of."""
    labels = piece_labels(faces, len(vertices))
    low = np.full((labels.max() + 1, 3), np.inf)
    high = -low
    for corner in range(3):
        np.minimum.at(low, labels, vertices[faces[:, corner]])
        np.maximum.at(high, labels, vertices[faces[:, corner]])
    # Numbers without faces belong to no piece.
    present = np.isfinite(low[:, 0])
    size = np.where(present, np.linalg.norm(np.where(present[:, None], high - low, 0.0), axis=1), 1)
    speck = size[labels] < _SPECK
    areas = face_areas(vertices, faces)
    if not speck.any() or areas[speck].sum() > _SPECK_AREA * areas.sum():
        return vertices, faces
    count = len(np.unique(labels[speck]))
    _count(notes, count, "pieces smaller than 1 % of the whole dropped: {}")
    return compact(vertices, faces[~speck])


def _count(notes: list[str], count: int, text: str) -> None:
    if count:
        notes.append(text.format(count))
