"""Builds an asset from a closed solid: scale, frame, stable poses, mass, collision mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from pydrake.math import RotationMatrix

from keypush.errors import UserError
from keypush.objects.asset import BOUNDING_RADIUS, ObjectAsset
from keypush.objects.mass import uniform_density
from keypush.objects.meshing.collision import collision_mesh
from keypush.objects.meshing.distance import hausdorff
from keypush.objects.meshing.felt import MOST_SUPPORT_GAP, pose_support_gap
from keypush.objects.resting import LEAST_TIPPING_ANGLE, RestingPose, find_resting_poses

Array = NDArray[np.float64]

DEFAULT_MASS = 0.1
"""kg."""
_AXES = {"x": np.array([1.0, 0, 0]), "y": np.array([0, 1.0, 0]), "z": np.array([0, 0, 1.0])}
_UP_TOLERANCE = np.deg2rad(20.0)
"""A pose counts as one with an axis up if it is turned from it by less than this."""


@dataclass(frozen=True, kw_only=True)
class BuildOptions:
    """What a solid does not say by itself."""

    diameter: float = 2 * BOUNDING_RADIUS
    """Of the bounding sphere about the middle of the upright object's bounding box, m."""
    up: str | None = None
    """Axis "x", "y" or "z" of the solid that points up; None: it rests as it does likeliest."""
    mass: float | None = None
    """kg; None: from the density, or else `DEFAULT_MASS`."""
    density: float | None = None
    """kg/m^3."""
    colour: tuple[float, float, float] = (0.55, 0.60, 0.66)
    """RGB in [0, 1]."""


def build_asset(
    name: str,
    solid: trimesh.Trimesh,
    options: BuildOptions,
    provenance: Mapping[str, Any],
) -> ObjectAsset:
    """Makes an object of a solid of any size, place and attitude.

    Args:
        name: of the object.
        solid: closed mesh, faces outwards; it is what is seen, too.
        options: what the solid does not say.
        provenance: where it comes from; what was found is added.

    Raises:
        UserError: it has no stable pose, none with that axis up, or cannot be made closed.
    """
    solid = solid.copy()
    _place(solid, RotationMatrix(), options.diameter)
    com, _ = uniform_density(solid, 1.0)
    upright = _choose_upright(name, find_resting_poses(solid, com), options.up)
    _place(solid, upright.R_WO, options.diameter)
    com, inertia = uniform_density(solid, 1.0)
    poses = _upright_first(find_resting_poses(solid, com))
    collision = collision_mesh(solid, poses)
    if not (collision.is_watertight and collision.is_winding_consistent and collision.volume > 0):
        raise UserError(
            f"object {name!r}: what touches cannot be made closed of it; allowed: a simpler mesh"
        )
    # What touches differs by a millimetre, which may be too much for a pose on a small edge.
    felt = [pose_support_gap(collision, solid, pose) < MOST_SUPPORT_GAP for pose in poses]
    poses = [pose for pose, enough in zip(poses, [True, *felt[1:]], strict=True) if enough]
    mass = options.mass
    if mass is None:
        density = options.density
        mass = DEFAULT_MASS if density is None else density * float(solid.volume)
    found = {
        "volume": float(solid.volume),
        "collision_distance": hausdorff(collision, solid),
        "poses_left_out": len(felt) - len(poses),
    }
    return ObjectAsset(
        name=name,
        visual=solid,
        collision=collision,
        colour=options.colour,
        mass=mass,
        p_OoOcm_O=com,
        inertia_per_mass=inertia,
        poses=tuple(poses),
        provenance={**provenance, **found},
    )


def _place(solid: trimesh.Trimesh, R: RotationMatrix, diameter: float) -> None:
    """Turns a solid, puts the middle of its bounding box at the origin, and scales it."""
    turned = np.asarray(solid.vertices) @ R.matrix().T
    centred = turned - (turned.min(axis=0) + turned.max(axis=0)) / 2
    radius = float(np.linalg.norm(centred, axis=1).max())
    solid.vertices = centred * (diameter / 2 / radius)


def _choose_upright(name: str, poses: list[RestingPose], up: str | None) -> RestingPose:
    if not poses:
        raise UserError(
            f"object {name!r} has no stable pose: it tips within "
            f"{np.rad2deg(LEAST_TIPPING_ANGLE):.0f} degrees however it stands; "
            "allowed: one that can stand"
        )
    if up is None:
        return poses[0]
    nearest = max(poses, key=lambda pose: float(-pose.down @ _AXES[up]))
    if -nearest.down @ _AXES[up] < np.cos(_UP_TOLERANCE):
        found = ", ".join(_direction(-pose.down) for pose in poses)
        raise UserError(f"object {name!r} cannot stand with {up} up; it can with {found} up")
    return nearest


def _direction(up: Array) -> str:
    axis = int(np.argmax(np.abs(up)))
    if abs(up[axis]) > np.cos(_UP_TOLERANCE):
        return ("" if up[axis] > 0 else "-") + "xyz"[axis]
    return "(" + ", ".join(f"{value:.2f}" for value in up) + ")"


def _upright_first(poses: list[RestingPose]) -> list[RestingPose]:
    poses = sorted(poses, key=lambda pose: float(pose.down[2]))
    # What is left of its rotation after `_place` is rounding.
    upright = replace(poses[0], R_WO=RotationMatrix())
    return [upright, *sorted(poses[1:], key=lambda pose: -pose.share)]
