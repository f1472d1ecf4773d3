"""The collision mesh of a solid: few faces, near to it, and true where it rests."""

import copy
from collections.abc import Sequence

import numpy as np
import trimesh
from manifold3d import Manifold
from numpy.typing import NDArray

from keypush.objects.manifolds import to_manifold, to_mesh
from keypush.objects.meshing.decimate import Decimator
from keypush.objects.meshing.distance import hausdorff
from keypush.objects.meshing.felt import FLAT
from keypush.objects.meshing.outline import simplify_outlines
from keypush.objects.meshing.refine import Support, refine_plane
from keypush.objects.meshing.skirt import with_skirt
from keypush.objects.meshing.surface import FREE, Surface
from keypush.objects.resting import TOUCH_TOLERANCE, RestingPose, support_polygon

Array = NDArray[np.float64]

MOST_FACES = 400
"""A collision mesh has no more faces, if it can be near enough with as many."""
CLOSE = 9e-4
"""Hausdorff distance from the solid up to which faces are left out at any rate, m."""
CLOSE_ENOUGH = 1.42e-3
"""The same, where there would be more than `MOST_FACES` otherwise, m."""
_FINE = 1e-4
"""The solid is simplified by this much before all else, m."""
_SAME = 1e-5
"""Vertices that are nearer than this are one, m."""
_OUTLINE = 3e-4
"""Outlines of resting faces are simplified by this much, m."""
_FREE_FACES = (2000, 1400, 1000, 700, 520, *range(420, 180, -30), 180, 140, 100, 60, 20)
"""Numbers of faces that are tried, besides those on which it rests."""
_MOST_FACES = 5000


def collision_mesh(solid: trimesh.Trimesh, poses: Sequence[RestingPose]) -> trimesh.Trimesh:
    """Makes the mesh that touches from a closed solid in O and its stable poses, upright first."""
    planes = np.array([[*pose.down, pose.height] for pose in poses])
    fine = _simplified(with_skirt(_flattened(solid, planes)))
    # What that moves onto the same corner becomes one.
    fine = _simplify(to_manifold(_flattened(fine, planes)), _SAME)
    labels, touching = _resting_faces(fine, planes)
    surface = Surface(fine, labels)
    simplify_outlines(surface, len(planes), _OUTLINE)
    decimator = Decimator(surface, planes, touching)
    supports = [_support(solid, pose) for pose in poses]
    supports[:1] = [supports[0].with_reaches(surface, 0)]
    resting = sum(label != FREE for label in surface.labels.values())
    best = None
    for count in _FREE_FACES:
        if best is not None and len(surface.faces) <= count + resting:
            continue
        decimator.reduce_to(count + resting)
        distance = hausdorff(surface.to_mesh(), solid)
        enough = CLOSE if best is not None and len(best.faces) <= MOST_FACES else CLOSE_ENOUGH
        if best is not None and distance > enough:
            break
        best = copy.deepcopy(surface)
        for plane, support in enumerate(supports):
            refine_plane(best, plane, support)
    assert best is not None
    return best.to_mesh()


def _support(solid: trimesh.Trimesh, pose: RestingPose) -> Support:
    polygon = support_polygon(np.asarray(solid.vertices), pose.R_WO, TOUCH_TOLERANCE)
    com_height = float(pose.R_WO.matrix()[2] @ solid.center_mass) + pose.height
    return Support(pose, polygon, com_height)


def _simplified(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Drops vertices that matter little, a little more at a time until few enough are left."""
    whole = to_manifold(mesh)
    tolerance, simple = _FINE, _simplify(whole, _FINE)
    while len(simple.faces) > _MOST_FACES and tolerance < CLOSE_ENOUGH / 2:
        tolerance *= 1.5
        simple = _simplify(whole, tolerance)
    return simple


def _simplify(solid: Manifold, tolerance: float) -> trimesh.Trimesh:
    """Simplifies by about `tolerance`, m, such that no edge has more than two faces.

    For manifold3d two edges may have the same ends; for a mesh they are then one.
    """
    for share in (1.0, 0.7, 1.4, 0.4, 2.0, 0.1):
        simple = to_mesh(solid.simplify(share * tolerance))
        if simple.is_watertight:
            return simple
    return to_mesh(solid)


def _flattened(mesh: trimesh.Trimesh, planes: Array) -> trimesh.Trimesh:
    """Moves what touches a resting plane into it."""
    vertices = np.array(mesh.vertices)
    touching = _depth(vertices, planes) < TOUCH_TOLERANCE
    for vertex in np.flatnonzero(touching.any(axis=1)):
        # A corner may lie in several planes: the least step that takes it into all of them.
        mine = planes[touching[vertex]]
        depth = mine[:, 3] - mine[:, :3] @ vertices[vertex]
        vertices[vertex] += np.linalg.lstsq(mine[:, :3], depth)[0]
    return trimesh.Trimesh(vertices, mesh.faces, process=False)


def _resting_faces(
    mesh: trimesh.Trimesh, planes: Array
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Returns for each face the plane in which it lies, (m,), and what vertices are in, (n, k)."""
    touching = _depth(np.asarray(mesh.vertices), planes) < FLAT
    labels = np.full(len(mesh.faces), FREE)
    for plane in range(len(planes)):
        outwards = mesh.face_normals @ planes[plane, :3] > 0.99
        labels[touching[mesh.faces, plane].all(axis=1) & outwards] = plane
    return labels, touching


def _depth(vertices: Array, planes: Array) -> Array:
    """How far vertices (n, 3) are inside planes (k, 4), (n, k), m."""
    return np.asarray(planes[:, 3] - vertices @ planes[:, :3].T)
