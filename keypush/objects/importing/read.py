"""Reads a mesh file: every geometry of it, where it stands, as one mesh."""

import hashlib
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
import trimesh
from trimesh.resolvers import FilePathResolver

from keypush.errors import UserError, one_line
from keypush.objects.importing.colour import average_colour, main_colour
from keypush.objects.importing.contents import as_utf8, read_contents
from keypush.objects.importing.result import Colour, Faces, Vertices

FORMATS = ("obj", "stl", "ply", "glb", "gltf", "off")
"""Extensions of the files that can be read."""
MAX_BYTES = 500_000_000
MAX_FACES = 2_000_000


@dataclass(frozen=True)
class MeshFile:
    """What a file holds, in its own units and frame."""

    mesh: trimesh.Trimesh
    """All its geometries; neither merged nor mended."""
    colour: Colour | None
    sha256: str


def check_file(path: Path) -> None:
    """Refuses what cannot be a mesh file by its name, kind or size.

    Raises:
        UserError: one line that names the file, what was found and what is allowed.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}; expected a mesh file ({_formats()})") from error
    if not path.is_file():
        kind = "a folder" if path.is_dir() else "not a file"
        raise UserError(f"{path}: {kind}; expected a mesh file ({_formats()})")
    if path.suffix.lower().removeprefix(".") not in FORMATS:
        raise UserError(f"{path}: unknown extension {path.suffix!r}; allowed: {_formats()}")
    if status.st_size == 0:
        raise UserError(f"{path}: the file is empty; expected a mesh")
    if status.st_size > MAX_BYTES:
        raise UserError(
            f"{path}: {status.st_size / 1e6:.0f} MB; allowed: at most {MAX_BYTES / 1e6:.0f} MB"
        )


def read_mesh(path: Path) -> MeshFile:
    """Reads a mesh file. Files beside it that it names are read too, others are not.

    Raises:
        UserError: no such file, not a mesh by its name, no faces, too many faces,
            vertices that are missing or not finite.
        Exception: whatever a reader raises about contents that are no mesh.
    """
    check_file(path)
    data = read_contents(path)
    scene = _load(path, data)
    placed = _placed(scene)
    count = sum(len(geometry.faces) for geometry, _ in placed)
    if count == 0:
        kinds = sorted({type(geometry).__name__ for geometry in scene.geometry.values()})
        found = f" ({', '.join(kinds)})" if kinds else ""
        raise UserError(f"{path}: no faces in it{found}; expected a mesh of triangles")
    if count > MAX_FACES:
        raise UserError(f"{path}: {count} faces; allowed: at most {MAX_FACES}")
    parts = [_transformed(path, geometry, transform) for geometry, transform in placed]
    first = np.cumsum([0] + [len(vertices) for vertices, _ in parts[:-1]])
    mesh = trimesh.Trimesh(
        np.vstack([vertices for vertices, _ in parts]),
        np.vstack([faces + n for (_, faces), n in zip(parts, first, strict=True)]),
        process=False,
    )
    colour = average_colour([(main_colour(geometry), geometry.area) for geometry, _ in placed])
    return MeshFile(mesh, colour, hashlib.sha256(data).hexdigest())


def _load(path: Path, data: bytes) -> trimesh.Scene:
    suffix = path.suffix.lower()
    try:
        # Unprocessed: merging is ours to do, and to tell. Never remote: nothing is downloaded.
        return trimesh.load_scene(
            BytesIO(as_utf8(data, suffix)),
            file_type=suffix.removeprefix("."),
            resolver=FilePathResolver(str(path)),
            process=False,
            allow_remote=False,
        )
    except FileNotFoundError as error:
        raise UserError(f"{path}: it names a file that is not there: {one_line(error)}") from error
    except ModuleNotFoundError as error:
        # trimesh asks for one that guesses encodings.
        raise UserError(f"{path}: cannot be read as a mesh: its text is not UTF-8") from error


def _placed(scene: trimesh.Scene) -> list[tuple[trimesh.Trimesh, Vertices]]:
    """Returns every mesh with its pose (4, 4), one that stands in several places several times."""
    placed = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry[name]
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            placed.append((geometry, np.asarray(transform, dtype=float)))
    return placed


def _transformed(
    path: Path, geometry: trimesh.Trimesh, transform: Vertices
) -> tuple[Vertices, Faces]:
    vertices = np.asarray(geometry.vertices, dtype=float)
    faces = np.asarray(geometry.faces, dtype=np.int64)
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise UserError(
            f"{path}: a face names vertex {faces.max()}; allowed: 0 to {len(vertices) - 1}"
        )
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    vertices = vertices[used] @ transform[:3, :3].T + transform[:3, 3]
    broken = int((~np.isfinite(vertices).all(axis=1)).sum())
    if broken:
        raise UserError(f"{path}: {broken} vertices are NaN or infinite; expected finite numbers")
    if np.linalg.det(transform[:3, :3]) < 0:
        faces = faces[:, ::-1]
    return vertices, faces


def _formats() -> str:
    return ", ".join(FORMATS)
