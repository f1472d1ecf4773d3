"""What a recording shows besides the simulated bodies: goal, floor, pedestal, camera."""

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Box, Cylinder, Meshcat, Rgba
from pydrake.math import RigidTransform

from keypush.scenario import Scenario

GOAL_COLOUR = Rgba(0.05, 0.55, 0.25, 1.0)
_GOAL_TINT = Rgba(0.10, 0.65, 0.30, 0.30)
_FLOOR_COLOUR = Rgba(0.80, 0.82, 0.85, 1.0)
_PEDESTAL_COLOUR = Rgba(0.36, 0.38, 0.42, 1.0)
_SKY, _HORIZON = [0.93, 0.95, 0.98], [0.99, 0.99, 1.0]
_FLOOR_RADIUS, _FLOOR_THICKNESS = 1.0, 0.01
_PEDESTAL_WIDTH = 0.22
_RING_WIDTH = 0.003
_RING_SIDES = 96
_ABOVE_TABLE = 6e-4
"""Decals lie this much above the table, m: nearer, they flicker with its face."""
_LOOK_AT = np.array([-0.17, 0.0, 0.17])
_CAMERA_DISTANCE, _CAMERA_HEIGHT = 1.65, 0.92
_CAMERA_AZIMUTHS_DEG = (-45.0, 45.0, -90.0, 90.0)
"""About Wz, from Wx: in front of the robot and at its sides."""
_FIELD_OF_VIEW_DEG = 40.0
_LIGHT = (0.5, 0.7, 1.8)
"""Where the light hangs, on the camera's side, whose shadows show what touches the table."""


def add_scenery(
    meshcat: Meshcat,
    scenario: Scenario,
    start: NDArray[np.float64],
    goal: NDArray[np.float64],
) -> None:
    """Draws, in W, what is seen but not simulated, and points the camera at the table.

    Args:
        meshcat: where to draw.
        scenario: sizes of table, robot base and goal.
        start: (2,) xy in W where the object starts, m.
        goal: (2,) goal xy in W, m.
    """
    for path in ("/Grid", "/Axes"):
        meshcat.SetProperty(path, "visible", False)
    meshcat.SetProperty("/Background/<object>", "top_color", _SKY)
    meshcat.SetProperty("/Background/<object>", "bottom_color", _HORIZON)
    meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=_FIELD_OF_VIEW_DEG))
    p_WC = camera_position(goal - start)
    meshcat.SetCameraPose(p_WC, _LOOK_AT)
    _light(meshcat, float(np.sign(p_WC[1])))
    _add_floor_and_pedestal(meshcat, scenario)
    _add_goal(meshcat, scenario.episode.goal_radius, goal)


def camera_position(push: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns p_WC, from where the hand hides the object least.

    Args:
        push: (2,) from start to goal in W; the hand is behind the object and comes along it.
    """
    azimuths = np.deg2rad(_CAMERA_AZIMUTHS_DEG)
    sides = np.stack([np.cos(azimuths), np.sin(azimuths)], axis=1)
    # Rounded, so that of two views that are equally good the first is taken.
    best = int(np.argmax(np.round(sides @ push / np.linalg.norm(push), 6)))
    x, y = _LOOK_AT[:2] + _CAMERA_DISTANCE * sides[best]
    return np.array([x, y, _CAMERA_HEIGHT])


def _light(meshcat: Meshcat, side: float) -> None:
    x, y, z = _LIGHT
    spot = "/Lights/SpotLight"
    meshcat.SetProperty(spot, "visible", True)
    meshcat.SetProperty(f"{spot}/<object>", "position", [x, side * y, z])
    meshcat.SetProperty(f"{spot}/<object>", "intensity", 17.0)
    meshcat.SetProperty(f"{spot}/<object>", "castShadow", True)
    meshcat.SetProperty(f"{spot}/<object>", "shadow.mapSize.width", 2048.0)
    meshcat.SetProperty(f"{spot}/<object>", "shadow.mapSize.height", 2048.0)
    meshcat.SetProperty(f"{spot}/<object>", "shadow.normalBias", 0.004)
    meshcat.SetProperty(f"{spot}/<object>", "shadow.radius", 4.0)
    for light in ("PointLightNegativeX", "PointLightPositiveX"):
        meshcat.SetProperty(f"/Lights/{light}/<object>", "intensity", 8.0)


def _add_floor_and_pedestal(meshcat: Meshcat, scenario: Scenario) -> None:
    height = scenario.table.height
    floor = Cylinder(_FLOOR_RADIUS, _FLOOR_THICKNESS)
    _put(meshcat, "/scenery/floor", floor, _FLOOR_COLOUR, [-0.2, 0, -height - _FLOOR_THICKNESS / 2])
    x, y, base = scenario.robot.base_position
    if base + height <= 0:
        return  # the robot stands on the floor, or below it
    pedestal = Box(_PEDESTAL_WIDTH, _PEDESTAL_WIDTH, base + height)
    _put(meshcat, "/scenery/pedestal", pedestal, _PEDESTAL_COLOUR, [x, y, (base - height) / 2])


def _add_goal(meshcat: Meshcat, radius: float, goal: NDArray[np.float64]) -> None:
    x, y = goal
    vertices, faces = _ring(radius - _RING_WIDTH, radius)
    meshcat.SetTriangleMesh("/goal/ring", vertices, faces, GOAL_COLOUR)
    meshcat.SetTransform("/goal/ring", RigidTransform(np.array([x, y, 2 * _ABOVE_TABLE])))
    disc, centre = Cylinder(radius, _ABOVE_TABLE), Cylinder(_RING_WIDTH, _ABOVE_TABLE)
    _put(meshcat, "/goal/disc", disc, _GOAL_TINT, [x, y, _ABOVE_TABLE])
    _put(meshcat, "/goal/centre", centre, GOAL_COLOUR, [x, y, 1.5 * _ABOVE_TABLE])


def _put(
    meshcat: Meshcat, path: str, shape: Box | Cylinder, colour: Rgba, p_WG: list[float]
) -> None:
    meshcat.SetObject(path, shape, colour)
    meshcat.SetTransform(path, RigidTransform(np.array(p_WG)))


def _ring(inner: float, outer: float) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Returns vertices (3, 2 n) and triangles (3, 2 n) of a flat ring about the origin."""
    angle = np.linspace(0.0, 2 * np.pi, _RING_SIDES, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(_RING_SIDES)])
    a = np.arange(_RING_SIDES)
    b = np.roll(a, -1)
    near, far = [a, a + _RING_SIDES, b + _RING_SIDES], [a, b + _RING_SIDES, b]
    faces = np.concatenate([near, far], axis=1)
    return np.concatenate([inner * circle, outer * circle], axis=1), faces.astype(np.int32)
