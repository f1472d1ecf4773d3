"""Divides the faces of a resting plane so that the support polygon is felt where it is."""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, cKDTree
from shapely.errors import GEOSException

from keypush.objects.meshing.caps import Cap, grid_points, triangulate_cap
from keypush.objects.meshing.felt import FLAT, support_gap, tipping_reach
from keypush.objects.meshing.outline import outline_loops
from keypush.objects.meshing.surface import FREE, Surface
from keypush.objects.resting import RestingPose

Array = NDArray[np.float64]

SUPPORT_GAPS = (8.5e-4, 9e-4)
"""The felt support polygon falls short of the true one by at most this, m: of an upright object,
which then tips within 1 mm of where it should on a hard table, and in other poses."""
STIFFNESSES = (5e10, 5e9)
"""Of the tables on which it matters where an upright object tips, Pa/m: one ten times as hard as
the one that ships, and that one (see `table`)."""
TIPPING_EXCESS, MEAN_EXCESS = 1e-3, 4.5e-4
"""There it tips at most so much sooner than with infinitely many faces, m: in any direction, and on
average over all."""
_WEIGHT = 1.0
"""N."""
_GRID = 5e-4
"""Spacing of the points that stand for infinitely many faces, m."""
_RIMS = ((0.0, 0.0), (2e-3, 2.5e-3), (1.4e-3, 1e-3), (8e-4, 2.5e-3), (8e-4, 1e-3), (5e-4, 1e-3),
         (5e-4, 0.0))  # fmt: skip
"""What is tried: width of a rim, and the distance from a line within which corners of its inside
are left out, m."""
_EAR_SHARE = 0.4
"""Share of an outline's edge that an ear takes at most."""
_SLIVER = 1e-9
"""Twice the area of a face that is none, m^2."""
_SHORT, _ROOM = 2.2, 1.5
"""Edges that are not so many times longer than an ear's gap, or than its side, are its side
whole."""
_STAGES = ((np.deg2rad(28.0), 4.5e-4, np.inf), (np.deg2rad(28.0), 4.5e-4, 0.02),
           (np.deg2rad(2.0), 4.5e-4, 0.02), (np.deg2rad(2.0), 2e-4, 0.02))  # fmt: skip
"""What is done to the outline, until the support is felt well enough: corners that turn by more
get an ear, whose centroid lies so far inside its corner, m; edges that are longer, m, are
divided."""


@dataclass(frozen=True)
class Support:
    """What a resting plane has to carry."""

    pose: RestingPose
    polygon: Array
    """The true support polygon (k, 2) in Wxy."""
    com_height: float
    """Height of the centre of mass above the plane, m."""
    reaches: tuple[Array, ...] = ()
    """For each of `STIFFNESSES` how far its COM may be in each direction, m; empty where it does
    not matter."""

    def with_reaches(self, surface: Surface, plane: int) -> "Support":
        """Measures how far the COM may be where the plane's faces are infinitely many."""
        R = self.pose.R_WO.matrix()
        loops = [_from_above(surface, loop, R) for loop in outline_loops(surface, plane)]
        if not loops:
            return self
        points = grid_points(loops, _GRID)
        areas = np.full(len(points), _GRID**2)
        return replace(
            self,
            reaches=tuple(
                tipping_reach(points, areas, _WEIGHT, self.com_height, k) for k in STIFFNESSES
            ),
        )

    def shortfall(self, felt: Array, areas: Array) -> float:
        """Returns how much of what is allowed is used: at most 1 where it is felt well enough.

        Args:
            felt: (n, 2) points of support in Wxy.
            areas: (n,) their areas, m^2.
        """
        worst = support_gap(felt, self.polygon) / SUPPORT_GAPS[0 if self.reaches else 1]
        for stiffness, ideal in zip(STIFFNESSES, self.reaches, strict=bool(self.reaches)):
            reach = tipping_reach(felt, areas, _WEIGHT, self.com_height, stiffness)
            excess = np.clip(ideal - reach, 0.0, None)
            worst = max(worst, excess.max() / TIPPING_EXCESS, excess.mean() / MEAN_EXCESS)
        return float(worst)


def refine_plane(surface: Surface, plane: int, support: Support) -> None:
    """Replaces the faces of a resting plane, by as few as the support needs.

    Args:
        surface: mesh under edit; faces in the plane have its number as their label.
        plane: number of the plane.
        support: what it has to carry.
    """
    R, height = support.pose.R_WO.matrix(), support.pose.height
    points = np.array(surface.points) @ R.T
    used = np.array([bool(faces) for faces in surface.around])
    touching: list[int] = np.flatnonzero(used & (points[:, 2] < -height + FLAT)).tolist()
    _label_flat_faces(surface, plane, set(touching), support.pose.down)
    if plane not in surface.labels.values():
        return  # it rests on corners and edges alone, which are felt where they are
    hull = points[touching, :2][ConvexHull(points[touching, :2]).vertices]
    lone = [v for v in touching if plane not in surface.planes_of(v)]
    alone = points[np.array(lone, dtype=np.int64), :2]
    turns = _hull_corners(surface, plane, R, hull)
    for least, gap, spacing in _STAGES:
        ears = {v for v, turn in turns.items() if turn > least}
        for v in ears:
            # The centroid of an isosceles triangle with sides s is 2/3 s sin(turn / 2) from its
            # top.
            side = 1.5 * gap / max(np.sin(turns[v] / 2), 1e-3)
            _make_room(surface, plane, v, side, _SHORT * gap)
        _divide_edges(surface, plane, spacing)
        loops = outline_loops(surface, plane)
        caps = _caps(surface, loops, ears, R)
        short = [_shortfall(support, cap, alone) for cap in caps]
        if min(short, default=np.inf) <= 1.0:
            break
    if not caps:
        return  # the outline crosses itself, by a hair: its faces stay as they are
    # Where none will do, the best, or almost as good a one with fewer faces.
    enough = max(1.0, 1.05 * min(short))
    cap = next(cap for cap, value in zip(caps, short, strict=True) if value <= enough)
    _replace(surface, plane, loops, cap, support.pose)


def _shortfall(support: Support, cap: Cap, alone: Array) -> float:
    """Of a cap together with corners that rest in the plane by themselves (n, 2)."""
    felt = np.vstack([cap.centroids(), alone])
    return support.shortfall(felt, np.concatenate([cap.areas(), np.zeros(len(alone))]))


def _label_flat_faces(surface: Surface, plane: int, touching: set[int], down: Array) -> None:
    """Labels faces that decimation has left in the plane."""
    for f, face in surface.faces.items():
        if surface.labels[f] == FREE and touching.issuperset(face):
            normal = surface.normals_area(face)
            # A sliver may face anywhere.
            if normal @ down > max(0.99 * float(np.linalg.norm(normal)), _SLIVER):
                surface.labels[f] = plane


def _from_above(surface: Surface, loop: list[int], R: Array) -> Array:
    """A loop's corners (n, 2) in Wxy in reverse: seen from above faces that face down run so."""
    return np.asarray((np.array([surface.points[v] for v in loop]) @ R.T)[::-1, :2])


def _hull_corners(surface: Surface, plane: int, R: Array, hull: Array) -> dict[int, float]:
    """Vertices of the plane's outlines at corners of their hull, and how far they turn there."""
    corners = cKDTree(hull)
    found: dict[int, float] = {}
    for loop in outline_loops(surface, plane):
        flat = _from_above(surface, loop, R)
        before, after = flat - np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0) - flat
        cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        turn = np.arctan2(cross, np.sum(before * after, axis=1))
        at = corners.query(flat)[0] < FLAT
        found |= {loop[-1 - i]: float(turn[i]) for i in np.flatnonzero(at)}
    return found


def _make_room(surface: Surface, plane: int, v: int, side: float, short: float) -> None:
    """Splits the outline's edges at a corner, so that an ear's sides end there."""
    for loop in outline_loops(surface, plane):
        if v not in loop:
            continue
        i = loop.index(v)
        for w in (loop[i - 1], loop[(i + 1) % len(loop)]):
            offset = surface.points[w] - surface.points[v]
            length = float(np.linalg.norm(offset))
            here = min(side, _EAR_SHARE * length)
            if length > _ROOM * here and length > short:
                surface.split(v, w, surface.points[v] + offset * (here / length))


def _divide_edges(surface: Surface, plane: int, spacing: float) -> None:
    """Divides the outline's edges that are longer than `spacing`, m, evenly."""
    for loop in outline_loops(surface, plane):
        for u, v in zip(loop, loop[1:] + loop[:1], strict=True):
            start, end = surface.points[u], surface.points[v]
            count = int(np.ceil(float(np.linalg.norm(end - start)) / spacing))
            last = u
            for k in range(1, count):
                last = surface.split(last, v, start + (end - start) * (k / count))


def _caps(surface: Surface, loops: list[list[int]], ears: set[int], R: Array) -> list[Cap]:
    """Returns the new faces that can be had, the fewest first."""
    flat = [_from_above(surface, loop, R) for loop in loops]
    places = []
    for k, loop in enumerate(loops):
        corners = [i for i, v in enumerate(reversed(loop)) if v in ears]
        # Two ears cannot share a side: of two corners that are next to each other one has to do.
        taken: set[int] = set()
        for i in corners:
            if not {(i - 1) % len(loop), (i + 1) % len(loop)} & taken and len(loop) > 3:
                taken.add(i)
        places += [(k, i) for i in taken]
    caps = []
    for rim, coarse in _RIMS:
        with suppress(GEOSException):
            caps.append(triangulate_cap(flat, places, rim, coarse))
    outline = [loop[::-1] for loop in loops]
    return sorted((cap for cap in caps if cap.closes(outline)), key=lambda cap: len(cap.faces))


def _replace(
    surface: Surface, plane: int, loops: list[list[int]], cap: Cap, pose: RestingPose
) -> None:
    for f in [f for f, label in surface.labels.items() if label == plane]:
        surface.remove_face(f)
    ids = [v for loop in loops for v in reversed(loop)]
    for x, y in cap.points[len(ids) :]:
        ids.append(surface.add_point(pose.R_WO.matrix().T @ np.array([x, y, -pose.height])))
    for a, b, c in cap.faces:
        surface.add_face((ids[c], ids[b], ids[a]), plane)
