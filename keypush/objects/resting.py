"""How a solid rests on a plane: its stable poses and their support polygons."""

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from pydrake.math import RotationMatrix
from scipy.spatial import ConvexHull

Array = NDArray[np.float64]

TOUCH_TOLERANCE = 1.5e-4
"""Points of a solid within this distance of the plane that it rests on touch it, m."""
LEAST_TIPPING_ANGLE = np.deg2rad(12.0)
"""A pose that tips at less is not stable: a sphere of many faces would have hundreds."""
MOST_POSES = 8
_SAME_DIRECTION = np.deg2rad(4.0)
"""Poses whose down directions are nearer to each other are one."""


@dataclass(frozen=True, eq=False)
class RestingPose:
    """A stable pose on a horizontal plane."""

    R_WO: RotationMatrix
    """Turns the object so that it rests on a horizontal plane."""
    height: float
    """Height of Oo above the plane, m."""
    tipping_angle: float
    """Least angle through which the plane has to tilt for the object to tip, rad."""
    share: float
    """Share of all directions in which gravity, from the centre of mass, meets the face that it
    rests on: how likely a tossed object ends like this, to first order."""

    @property
    def down(self) -> Array:
        """Unit vector (3,) in O towards the plane."""
        return np.asarray(-self.R_WO.matrix()[2])


def find_resting_poses(mesh: trimesh.Trimesh, p_OoOcm_O: Array) -> list[RestingPose]:
    """Finds the stable poses of a solid, the likeliest first, at most `MOST_POSES`.

    A pose is stable if the centre of mass is over the support polygon, so far inside that the
    plane can tilt by `LEAST_TIPPING_ANGLE`.

    Args:
        mesh: closed mesh in O, m.
        p_OoOcm_O: centre of mass (3,) in O.
    """
    vertices = np.asarray(mesh.vertices)
    hull = ConvexHull(vertices)
    corners = vertices[hull.vertices]
    found: list[RestingPose] = []
    for normal, offset in _planes_by_area(vertices, hull):
        if any(np.dot(normal, pose.down) > np.cos(_SAME_DIRECTION) for pose in found):
            continue
        pose = _rest_on(corners, normal, offset, p_OoOcm_O)
        if pose is not None:
            found.append(pose)
    return sorted(found, key=lambda pose: -pose.share)[:MOST_POSES]


def upright_rotation(down: Array) -> RotationMatrix:
    """Returns the rotation R_WO by the least angle that turns a direction in O to -Wz."""
    axis = np.cross(down, [0.0, 0.0, -1.0])
    sine, cosine = float(np.linalg.norm(axis)), float(-down[2])
    if sine < 1e-12:
        return RotationMatrix() if cosine > 0 else RotationMatrix.MakeXRotation(np.pi)
    k = axis / sine
    K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    # Rodrigues' formula.
    return RotationMatrix.ProjectToRotationMatrix(np.eye(3) + sine * K + (1 - cosine) * K @ K)


def support_polygon(vertices: Array, R_WO: RotationMatrix, tolerance: float) -> Array:
    """Returns the convex hull (k, 2) in Wxy, anticlockwise, of what touches the plane.

    Args:
        vertices: (n, 3) in O.
        R_WO: how the object rests.
        tolerance: height in m above the lowest point below which a vertex touches.
    """
    p_W = vertices @ R_WO.matrix().T
    base = p_W[p_W[:, 2] < p_W[:, 2].min() + tolerance, :2]
    return np.asarray(base[ConvexHull(base).vertices])


def edge_distance(polygon: Array, point: Array) -> float:
    """Returns how far a point (2,) is inside a convex anticlockwise polygon, m; < 0 outside."""
    return float(np.min(edge_gaps(polygon, point)[1]))


def edge_gaps(polygon: Array, point: Array) -> tuple[Array, Array]:
    """Looks from a point (2,) at the sides of a convex anticlockwise polygon (k, 2).

    Returns:
        The sides' outward unit normals (k, 2), and how far inside of each the point is, (k,), m.
    """
    side = np.roll(polygon, -1, axis=0) - polygon
    normals = np.column_stack([side[:, 1], -side[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return normals, np.sum(normals * (polygon - point), axis=1)


def room(normals: Array, gaps: Array, u: Array) -> float:
    """Returns how far one can go along u (2,) before one of the gaps (k,) is used up, m.

    Args:
        normals: (k, 2) outward, of what bounds the way.
        gaps: distances to it, not negative, m.
        u: unit vector.
    """
    rates = normals @ u
    ahead = rates > 1e-9
    return float(np.min(gaps[ahead] / rates[ahead]))


def _planes_by_area(vertices: Array, hull: ConvexHull) -> list[tuple[Array, float]]:
    """Normal and offset of the hull's facets; coplanar triangles count together."""
    keys, index = np.unique(hull.equations.round(5), axis=0, return_inverse=True)
    triangles = vertices[hull.simplices]
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.zeros(len(keys))
    np.add.at(area, index.ravel(), np.linalg.norm(cross, axis=1) / 2)
    first = np.zeros(len(keys), dtype=np.int64)
    first[index.ravel()[::-1]] = np.arange(len(index.ravel()))[::-1]
    order = np.argsort(-area, kind="stable")
    return [(hull.equations[first[i], :3], -float(hull.equations[first[i], 3])) for i in order]


def _rest_on(corners: Array, normal: Array, offset: float, p_OoOcm_O: Array) -> RestingPose | None:
    touching = corners[corners @ normal > offset - TOUCH_TOLERANCE]
    R_WO = upright_rotation(normal)
    flat = (touching @ R_WO.matrix().T)[:, :2]
    if len(flat) < 3 or np.linalg.matrix_rank(flat - flat[0], tol=1e-5) < 2:
        return None
    polygon = flat[ConvexHull(flat).vertices]
    com = R_WO.matrix() @ p_OoOcm_O
    height = float(com[2] + offset)
    angle = float(np.arctan2(edge_distance(polygon, com[:2]), height))
    if angle < LEAST_TIPPING_ANGLE:
        return None
    return RestingPose(R_WO, offset, angle, _solid_angle(polygon - com[:2], height) / (4 * np.pi))


def _solid_angle(polygon: Array, height: float) -> float:
    """Solid angle of a polygon at `height` below the origin, sr."""
    total = 0.0
    corners = np.column_stack([polygon, np.full(len(polygon), height)])
    lengths = np.linalg.norm(corners, axis=1)
    for i in range(1, len(corners) - 1):
        a, b, c = corners[0], corners[i], corners[i + 1]
        la, lb, lc = lengths[0], lengths[i], lengths[i + 1]
        # Source: Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", 1983.
        above = float(np.dot(a, np.cross(b, c)))
        below = la * lb * lc + (a @ b) * lc + (b @ c) * la + (c @ a) * lb
        total += 2 * np.arctan2(abs(above), below)
    return total
