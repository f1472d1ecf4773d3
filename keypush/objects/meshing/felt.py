"""The support polygon that Drake's contact feels, against the true one.

Drake integrates hydroelastic pressure with one point per contact polygon, its centroid. So an
object that rests on a face feels support at that face's centroid, not at its corners.
"""

import numpy as np
import trimesh
from numpy.typing import NDArray
from pydrake.math import RotationMatrix
from scipy.spatial import QhullError

from keypush.objects.resting import TOUCH_TOLERANCE, RestingPose, support_polygon

Array = NDArray[np.float64]

MOST_SUPPORT_GAP = 1e-3
"""How far the felt polygon may fall short of the true one in a pose in which an object rests, m."""
FLAT = 1e-6
"""Vertices within this distance in m of the lowest one lie in the plane."""
_DIRECTIONS = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
_TIPPING_DIRECTIONS = np.linspace(0.0, 2 * np.pi, 36, endpoint=False)
_LINES = 40
_MOST_TILT = 0.02
"""rad"""
_NOTHING = 1e-30
"""Stands for the first moment of no area at all, m^3."""


def felt_points(mesh: trimesh.Trimesh, R_WO: RotationMatrix) -> Array:
    """Returns where a resting mesh feels support, (n, 2) in Wxy.

    These are the centroids of the faces in the plane, and the corners in the plane that belong to
    none of them: there the contact polygon is the tip of a corner.
    """
    p_W = np.asarray(mesh.vertices) @ R_WO.matrix().T
    low = p_W[:, 2] < p_W[:, 2].min() + FLAT
    faces = np.asarray(mesh.faces)
    flat = faces[low[faces].all(axis=1)]
    alone = low.copy()
    alone[flat.ravel()] = False
    return np.vstack([p_W[flat].mean(axis=1)[:, :2], p_W[alone, :2]])


def support_gap(felt: Array, polygon: Array) -> float:
    """Returns by how much the felt polygon falls short of the true one at worst, m.

    It is the Hausdorff distance of the two convex hulls where the felt one lies inside.

    Args:
        felt: (n, 2) points of support.
        polygon: (k, 2) corners of the true polygon.
    """
    directions = np.column_stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])
    gap = (polygon @ directions.T).max(axis=0) - (felt @ directions.T).max(axis=0)
    return float(gap.max())


def pose_support_gap(mesh: trimesh.Trimesh, seen: trimesh.Trimesh, pose: RestingPose) -> float:
    """Returns by how much support falls short in a pose, m; infinity where it touches in a line.

    Args:
        mesh: what touches.
        seen: what the object is.
        pose: one in which it rests.
    """
    try:
        true = support_polygon(np.asarray(seen.vertices), pose.R_WO, TOUCH_TOLERANCE)
    except QhullError:
        return float("inf")
    return support_gap(felt_points(mesh, pose.R_WO), true)


def tipping_reach(
    felt: Array, areas: Array, weight: float, com_height: float, stiffness: float
) -> Array:
    """Returns how far the centre of mass may be in each direction before the object tips, (d,), m.

    The plane is a foundation that only presses. An object that tilts by phi about a line stands
    on what is felt beyond the line: stiffness times phi times the first moment of that area is
    the weight, and the pressure's centre is where the COM may at most be, which has moved by
    com_height times phi meanwhile. Of all lines for which phi is small the best counts.

    Args:
        felt: (n, 2) points of support in Wxy.
        areas: (n,) their areas, m^2.
        weight: N.
        com_height: of the centre of mass above the plane, m.
        stiffness: of the foundation, Pa/m.
    """
    reach = []
    for angle in _TIPPING_DIRECTIONS:
        s = felt @ np.array([np.cos(angle), np.sin(angle)])
        lines = s.max() - np.geomspace(1e-5, max(float(np.ptp(s)), 2e-5), _LINES)
        moments = np.clip(s - lines[:, None], 0.0, None) * areas
        total = np.maximum(moments.sum(axis=1), _NOTHING)
        tilt = weight / (stiffness * total)
        place = (moments @ s) / total - com_height * tilt
        # The last line has everything beyond it, so that it tilts least.
        reach.append(float(np.max(place, where=tilt <= _MOST_TILT, initial=place[-1])))
    return np.array(reach)
