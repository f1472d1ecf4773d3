"""The Panda's looks: the manufacturer's meshes from the package `example-robot-data`.

The meshes are neither copied into this repository nor downloaded at run time: they are read
from the installed package (COLLADA), decimated and handed to Drake as glTF in memory.
"""

from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import cast

import numpy as np
import trimesh
from pydrake.common import MemoryFile
from pydrake.geometry import InMemoryMesh, Mesh
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant

from keypush.errors import UserError
from keypush.robot.panda import Panda

_PACKAGE = "example-robot-data"
_FOLDER = "panda_description/meshes/visual"
_KEEP = 0.5
"""Share of the triangles that is kept: 67,000 of 134,000 on the whole arm."""
_CREASE = np.deg2rad(30.0)
"""Edges sharper than this stay sharp."""
_MIN_FACES = 100
_Z_UP_TO_Y_UP = trimesh.transformations.rotation_matrix(-np.pi / 2, [1.0, 0.0, 0.0])
_RIGHT_FINGER = RigidTransform(RotationMatrix.MakeZRotation(np.pi))


def add_panda_visuals(plant: MultibodyPlant, panda: Panda) -> None:
    """Registers the arm's visual meshes; call it before `plant.Finalize()`.

    The plant must be a source for a SceneGraph. Visual geometry takes no part in contact.

    Raises:
        UserError: the package with the meshes is not installed or lacks them.
    """
    parts = [(f"panda_link{i}", f"link{i}", RigidTransform()) for i in range(8)]
    parts += [
        ("panda_hand", "hand", RigidTransform()),
        ("panda_leftfinger", "finger", RigidTransform()),
        ("panda_rightfinger", "finger", _RIGHT_FINGER),
    ]
    folder = _mesh_folder()
    meshes = {name: _load(folder / f"{name}.dae") for name in sorted({part[1] for part in parts})}
    for link, name, X_BG in parts:
        body = plant.GetBodyByName(link, panda.instance)
        plant.RegisterVisualGeometry(body, X_BG, meshes[name], f"{link}_visual", np.ones(4))


def _mesh_folder() -> Path:
    try:
        listed = files(_PACKAGE) or []
    except PackageNotFoundError as error:
        raise UserError(
            f"the Panda's visual meshes need the Python package {_PACKAGE}, which is not installed"
        ) from error
    for file in listed:
        path = Path(str(file.locate()))
        if path.name == "link0.dae" and path.parent.as_posix().endswith(_FOLDER) and path.is_file():
            return path.parent
    raise UserError(f"the installed package {_PACKAGE} holds no folder {_FOLDER} with link0.dae")


def _load(path: Path) -> Mesh:
    """Reads one link's COLLADA file, (z up, m), as a Drake mesh with the file's colours."""
    scene = trimesh.Scene()
    for color, mesh in _by_color(path).items():
        mesh.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(
                baseColorFactor=_linear(color), metallicFactor=0.1, roughnessFactor=0.6
            )
        )
        scene.add_geometry(mesh)
    # glTF is y up, and Drake turns it back.
    scene.apply_transform(_Z_UP_TO_Y_UP)
    gltf = trimesh.exchange.gltf.export_gltf(scene, include_normals=True, embed_buffers=True)
    contents = gltf["model.gltf"]
    return Mesh(InMemoryMesh(mesh_file=MemoryFile(contents, ".gltf", path.stem)))


def _by_color(path: Path) -> dict[tuple[int, ...], trimesh.Trimesh]:
    """Returns the decimated triangles of each colour (RGBA, 0 to 255)."""
    parts: dict[tuple[int, ...], list[trimesh.Trimesh]] = {}
    for mesh in trimesh.load_scene(path).dump():
        # COLLADA gives every surface a material.
        assert isinstance(mesh, trimesh.Trimesh)
        assert isinstance(mesh.visual, trimesh.visual.TextureVisuals)
        color = tuple(int(c) for c in mesh.visual.material.main_color)
        parts.setdefault(color, []).append(_decimate(mesh))
    return {c: cast(trimesh.Trimesh, trimesh.util.concatenate(m)) for c, m in parts.items()}


def _linear(color: tuple[int, ...]) -> tuple[float, ...]:
    """COLLADA colours are as shown (gamma 2.2), those of glTF are linear; alpha is neither."""
    *rgb, alpha = (c / 255.0 for c in color)
    return (*(c**2.2 for c in rgb), alpha)


def _decimate(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    mesh = trimesh.Trimesh(mesh.vertices, mesh.faces)
    mesh.merge_vertices()
    target = max(_MIN_FACES, round(_KEEP * len(mesh.faces)))
    if target < len(mesh.faces):
        mesh = mesh.simplify_quadric_decimation(face_count=target)
    shaded: trimesh.Trimesh = trimesh.graph.smooth_shade(mesh, angle=_CREASE)
    return shaded
