"""What the policy saw and chose, added to a recording: noisy clouds and keypoints.

A Meshcat animation moves, shows and hides objects but cannot redraw one. So every policy
step has a cloud of its own, which is visible for that step alone.
"""

import math

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Cylinder, Meshcat, MeshcatAnimation, MeshcatCone, Rgba, Shape, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.perception import PointCloud

Array = NDArray[np.float64]

CLOUD_COLOUR = Rgba(0.02, 0.04, 0.16, 1.0)
KEYPOINT_COLOUR = Rgba(0.95, 0.10, 0.45, 1.0)
_POINT_SIZE = 0.0034
_KEYPOINT_RADIUS = 0.006
_HEAD_RADIUS, _HEAD_LENGTH = 0.006, 0.015
_SHAFT_RADIUS, _SHAFT_LENGTH = 0.002, 0.04
_SHAFT_END = _KEYPOINT_RADIUS + _HEAD_LENGTH
_MOST_POINTS = 512
_MOST_CLOUDS = 300
"""With 512 points each they add 2.5 MB to the page."""


def animate_clouds(meshcat: Meshcat, animation: MeshcatAnimation, clouds: Array) -> None:
    """Shows cloud k of (n, N, 3) from frame k on; few enough of them that the page stays small."""
    stride = math.ceil(len(clouds) / _MOST_CLOUDS)
    for first in range(0, len(clouds), stride):
        path = f"/point_cloud/{first:05d}"
        points = clouds[first][:_MOST_POINTS]
        cloud = PointCloud(len(points))
        cloud.mutable_xyzs()[:] = points.T
        meshcat.SetObject(path, cloud, _POINT_SIZE, CLOUD_COLOUR)
        meshcat.SetProperty(path, "visible", first == 0)
        animation.SetProperty(0, path, "visible", first == 0)
        animation.SetProperty(first, path, "visible", True)
        if first + stride < len(clouds):
            animation.SetProperty(first + stride, path, "visible", False)


def animate_keypoint(
    meshcat: Meshcat, animation: MeshcatAnimation, keypoints: Array, goal: Array
) -> None:
    """Moves a sphere to keypoint k in frame k, with an arrow that points to the goal.

    Neither is seen in frames whose keypoint is NaN.

    Args:
        meshcat: where a sphere and an arrow are drawn.
        animation: gets the frames.
        keypoints: (n, 3) p_WK in m.
        goal: (2,) goal xy in W, m.
    """
    _draw_keypoint(meshcat)
    seen = np.isfinite(keypoints).all(axis=1)
    for frame, p_WK in enumerate(keypoints):
        if frame == 0 or seen[frame] != seen[frame - 1]:
            animation.SetProperty(frame, "/keypoint", "visible", bool(seen[frame]))
        if not seen[frame]:
            continue
        dx, dy = goal - p_WK[:2]
        R_WK = RotationMatrix.MakeZRotation(math.atan2(dy, dx))
        animation.SetTransform(frame, "/keypoint", RigidTransform(R_WK, p_WK))


def _draw_keypoint(meshcat: Meshcat) -> None:
    """A sphere, and an arrow along x that ends at it: the tool comes from behind."""
    parts: dict[str, tuple[Shape, float, float]] = {
        "point": (Sphere(_KEYPOINT_RADIUS), 0.0, 0.0),
        "shaft": (
            Cylinder(_SHAFT_RADIUS, _SHAFT_LENGTH),
            np.pi / 2,
            -_SHAFT_END - _SHAFT_LENGTH / 2,
        ),
        # The cone's tip is its origin and it widens along +z.
        "head": (
            MeshcatCone(_HEAD_LENGTH, _HEAD_RADIUS, _HEAD_RADIUS),
            -np.pi / 2,
            -_KEYPOINT_RADIUS,
        ),
    }
    for name, (shape, pitch, x) in parts.items():
        path = f"/keypoint/{name}"
        meshcat.SetObject(path, shape, KEYPOINT_COLOUR)
        R = RotationMatrix.MakeYRotation(pitch)
        meshcat.SetTransform(path, RigidTransform(R, np.array([x, 0.0, 0.0])))
        # Seen through the object, on whose far side it often is; drawn last to cover it.
        meshcat.SetProperty(f"{path}/<object>", "material.depthTest", False)
        meshcat.SetProperty(f"{path}/<object>", "material.transparent", True)
        meshcat.SetProperty(f"{path}/<object>", "renderOrder", 1.0)
