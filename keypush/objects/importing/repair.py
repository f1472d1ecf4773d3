"""Closes a surface: by turning faces and filling holes, or else by a solid around it."""

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold

from keypush.objects.importing.clean import Cleaned
from keypush.objects.importing.decimate import decimate_solid
from keypush.objects.importing.holes import fill_holes
from keypush.objects.importing.manifolds import as_solid, join
from keypush.objects.importing.result import Faces, Vertices
from keypush.objects.importing.topology import (
    NO_VOLUME,
    compact,
    face_areas,
    orient,
    piece_volumes,
    signed_volume,
)
from keypush.objects.importing.wrap import CELLS, wrap

_FEW = 0.01
_INSIDE = 0.4
_COARSE_CELLS = CELLS // 2


@dataclass(frozen=True)
class Repaired:
    """A solid of at most `MAX_SOLID_FACES` faces and what was done to get it."""

    solid: Manifold
    notes: list[str]


@dataclass
class _Pieces:
    """What became of the pieces of a surface."""

    solids: list[Manifold]
    open: list[Faces]
    holes: int = 0
    flat: int = 0


def repair(surface: Cleaned) -> Repaired:
    """Makes a solid of a surface of size 1."""
    notes: list[str] = []
    solid = as_solid(surface.vertices, surface.faces)
    if solid is None:
        solid = _close(surface.vertices, surface.faces, notes)
    else:
        _tell_inverted(surface, notes)
    fewer = decimate_solid(solid)
    if fewer is None:
        notes.append("too many small parts to keep: took a coarse solid around them")
        fewer = decimate_solid(wrap(surface.vertices, surface.faces, _COARSE_CELLS))
    if fewer is None:
        notes.append("took the convex hull")
        fewer = convex_hull(surface.vertices)
    elif fewer.num_tri() < solid.num_tri():
        notes.append(f"reduced the solid from {solid.num_tri()} to {fewer.num_tri()} faces")
    return Repaired(fewer, notes)


def convex_hull(vertices: Vertices) -> Manifold:
    """Returns the hull of points (n, 3) of size 1, with few faces; empty if they are coplanar."""
    hull = Manifold.hull_points(np.ascontiguousarray(vertices))
    fewer = hull if hull.is_empty() else decimate_solid(hull)
    return hull if fewer is None else fewer


def _tell_inverted(surface: Cleaned, notes: list[str]) -> None:
    """Says which pieces of a closed surface `as_solid` turned outwards."""
    inverted = piece_volumes(surface.vertices, surface.faces) < 0
    if inverted.any():
        some = f"pieces that faced inwards turned, cavities filled: {inverted.sum()}"
        notes.append("turned all faces outwards" if inverted.all() else some)


def _close(vertices: Vertices, faces: Faces, notes: list[str]) -> Manifold:
    """Closes each piece by itself and joins them."""
    _, one = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    if len(one) < len(faces):
        notes.append(f"faces there with both sides, one dropped: {len(faces) - len(one)}")
    faces, labels, one_sided = orient(faces[np.sort(one)])
    pieces = _close_pieces(vertices, faces, labels, one_sided)
    if pieces.holes:
        notes.append(f"holes closed: {pieces.holes}")
    area = face_areas(vertices, faces).sum()
    left = sum(face_areas(vertices, piece).sum() for piece in pieces.open)
    if pieces.solids and left < _FEW * area:
        pieces.flat += len(pieces.open)
        pieces.open = []
    if pieces.flat and pieces.solids:
        notes.append(f"flat or negligible open pieces dropped: {pieces.flat}")
    if pieces.open or not pieces.solids:
        around = np.vstack(pieces.open) if pieces.open else faces
        walls = wrap(*compact(vertices, around))
        if pieces.solids and _is_within(walls, pieces.solids):
            notes.append(f"open pieces in or on closed ones dropped: {len(pieces.open)}")
        else:
            share = left / area if pieces.open else 1.0
            notes.append(
                f"{share:.0%} of the surface cannot be closed: gave it walls 3 % of its size thick"
            )
            pieces.solids.append(walls)
    if len(pieces.solids) > 1:
        notes.append(f"closed pieces joined: {len(pieces.solids)}")
    solid = join(pieces.solids)
    return wrap(vertices, faces) if solid is None else solid


def _is_within(walls: Manifold, solids: list[Manifold]) -> bool:
    """Says whether walls stand inside of solids, or lie on them with one side."""
    whole = join(solids)
    return whole is not None and (walls ^ whole).volume() > _INSIDE * walls.volume()


def _close_pieces(
    vertices: Vertices, faces: Faces, labels: np.ndarray, one_sided: np.ndarray
) -> _Pieces:
    result = _Pieces([], [])
    order = np.argsort(labels, kind="stable")
    starts = np.flatnonzero(np.diff(labels[order])) + 1
    for members in np.split(order, starts):
        piece = faces[members]
        filled = None if labels[members[0]] in one_sided else fill_holes(vertices, piece)
        if filled is None:
            result.open.append(piece)
            continue
        closed, holes = filled
        if abs(signed_volume(vertices, closed)) < NO_VOLUME:
            result.flat += 1
            continue
        solid = as_solid(*compact(vertices, closed))
        if solid is None:
            result.open.append(piece)
        else:
            result.solids.append(solid)
            result.holes += holes
    return result
