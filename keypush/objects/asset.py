"""ObjectAsset: an object as it is stored, built in or a user's own, at its nominal size.

An asset is a folder with `visual.ply` (what is seen), `collision.obj` (what touches) and
`object.json` (all else). Lengths are in m, in the object's frame O: upright, z up, Oo in the
centre of its bounding box, whose corners' sphere about Oo has the radius `BOUNDING_RADIUS`.
"""

import io
import json
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from keypush.errors import UserError, one_line
from keypush.objects.description import FORMAT, read_description
from keypush.objects.resting import RestingPose
from keypush.scenario_check import SURFACE_POINTS
from keypush.seeding import make_generator

Array = NDArray[np.float64]

BOUNDING_RADIUS = 0.05
"""r_obj in m: radius of the bounding sphere about Oo at size ratio 1."""
_VISUAL, _COLLISION, _DESCRIPTION = "visual.ply", "collision.obj", "object.json"
ASSET_FILES = (_COLLISION, _DESCRIPTION, _VISUAL)
"""All that an asset is read from."""


@dataclass(frozen=True, eq=False)
class ObjectAsset:
    """An object at size ratio 1."""

    name: str
    visual: trimesh.Trimesh
    """What is seen and sampled."""
    collision: trimesh.Trimesh
    """What touches: closed, few faces, fine where it rests."""
    colour: tuple[float, float, float]
    """RGB in [0, 1]."""
    mass: float
    """kg, where the scenario gives none."""
    p_OoOcm_O: Array
    """Centre of mass of uniform density, (3,)."""
    inertia_per_mass: Array
    """Inertia about the centre of mass over mass, (3, 3), m^2."""
    poses: tuple[RestingPose, ...]
    """Stable poses; the first is upright."""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    """Where it comes from and what was done to it."""

    @cached_property
    def surface_samples(self) -> Array:
        """Points (`SURFACE_POINTS`, 3) drawn uniformly by area."""
        rng = make_generator(0, 0, f"surface:{self.name}")
        triangles = np.asarray(self.visual.vertices)[np.asarray(self.visual.faces)]
        area = np.asarray(self.visual.area_faces)
        chosen = rng.choice(len(area), size=SURFACE_POINTS, p=area / area.sum())
        # Source: Osada et al., "Shape Distributions", 2002, eq. (1).
        root, share = np.sqrt(rng.random(SURFACE_POINTS)), rng.random(SURFACE_POINTS)
        weights = np.column_stack([1 - root, root * (1 - share), root * share])
        return np.asarray(np.einsum("nk,nkd->nd", weights, triangles[chosen]))


def write_asset(asset: ObjectAsset, folder: Path) -> None:
    """Writes an asset to a folder that does not exist yet: whole, or not at all.

    Raises:
        UserError: the folder exists, or cannot be written.
    """
    if folder.exists():
        raise UserError(f"object {asset.name!r}: {folder} exists; allowed: another name")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        # Its name begins with a dot, which no object's does: it never counts as one.
        partial = Path(tempfile.mkdtemp(prefix=".", dir=folder.parent))
    except OSError as error:
        raise UserError(f"object folder {folder}: cannot be written: {one_line(error)}") from error
    try:
        partial.chmod(0o755)
        (partial / _VISUAL).write_bytes(cast(bytes, asset.visual.export(file_type="ply")))
        (partial / _COLLISION).write_text(obj_text(asset.collision), encoding="utf-8")
        text = json.dumps(_describe(asset), indent=1) + "\n"
        (partial / _DESCRIPTION).write_text(text, encoding="utf-8")
        partial.rename(folder)
    except OSError as error:
        raise UserError(f"object folder {folder}: cannot be written: {one_line(error)}") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def read_asset(folder: Path) -> ObjectAsset:
    """Reads an asset.

    Raises:
        UserError: a file is missing or damaged; names it, and the field.
    """
    try:
        described = _read_description(folder / _DESCRIPTION)
        return ObjectAsset(
            name=folder.name,
            visual=_read_mesh(folder / _VISUAL),
            collision=_read_mesh(folder / _COLLISION),
            **described,
        )
    except Exception as error:  # the mesh readers raise whatever a damaged file leads to
        raise UserError(
            f"object folder {folder}: cannot be read: {one_line(error)}; "
            "allowed: what `keypush objects add` wrote"
        ) from error


def obj_text(mesh: trimesh.Trimesh) -> str:
    """Returns a mesh as OBJ text with nine digits, which keeps flat faces flat."""
    text = io.StringIO()
    for x, y, z in np.asarray(mesh.vertices):
        text.write(f"v {x:.9g} {y:.9g} {z:.9g}\n")
    for a, b, c in np.asarray(mesh.faces) + 1:
        text.write(f"f {a} {b} {c}\n")
    return text.getvalue()


def _read_description(path: Path) -> dict[str, Any]:
    try:
        return read_description(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path.name}: {error}") from error


def _read_mesh(path: Path) -> trimesh.Trimesh:
    mesh = trimesh.load_mesh(path, process=False)
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise ValueError(f"{path.name} holds no mesh")
    return trimesh.Trimesh(
        np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces), process=False
    )


def _describe(asset: ObjectAsset) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "colour": list(asset.colour),
        "mass": asset.mass,
        "centre_of_mass": asset.p_OoOcm_O.tolist(),
        "inertia_per_mass": asset.inertia_per_mass.tolist(),
        "resting_poses": [
            {
                "quaternion_wxyz": pose.R_WO.ToQuaternion().wxyz().tolist(),
                "height": pose.height,
                "tipping_angle": pose.tipping_angle,
                "share": pose.share,
            }
            for pose in asset.poses
        ],
        "provenance": dict(asset.provenance),
    }
