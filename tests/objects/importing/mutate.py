"""Makes mesh files that are broken or odd, always the same ones."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import trimesh
from shapely.geometry import Polygon

FORMATS = ("obj", "stl", "ply", "glb", "gltf", "off", "ascii.stl", "ascii.ply")

Rng = np.random.Generator
Mesh = trimesh.Trimesh
MeshChange = Callable[[Mesh, Rng], Mesh]
ByteChange = Callable[[bytes, Rng], bytes]


def fuzz_files(count: int, folder: Path) -> Iterator[Path]:
    """Writes broken or odd mesh files, one after the other; file n depends on n alone.

    The kinds of damage take turns, so that few files show many of them.

    Args:
        count: number of files.
        folder: where they go, each in a folder of its own.
    """
    for number in range(count):
        rng = np.random.default_rng([2024, number])
        # 11 shares no factor with the number of kinds, so the steps pass through all of them.
        kind = (number * 11) % (len(_MESH_CHANGES) + len(_BYTE_CHANGES) + len(_WHOLE_FILES))
        place = folder / f"{number:04d}"
        place.mkdir(parents=True)
        yield _write(kind, place, rng)


def base_mesh(rng: Rng) -> Mesh:
    """Returns one of the things that files are made of, in a random place, size and pose."""
    mesh = _BASES[rng.integers(len(_BASES))]()
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
    mesh.apply_scale(10.0 ** rng.uniform(-2, 2))
    mesh.apply_translation(rng.normal(size=3))
    return mesh


def cup(segments: int = 24, height: float = 1.4, thickness: float = 0.0) -> Mesh:
    """Returns an upright cup of radius 0.5 to 0.6, of one surface or with a wall."""
    outer = [(0.0, 0.0), (0.5, 0.0), (0.6, height)]
    inner = [(0.6 - thickness, height), (0.5 - thickness, thickness), (0.0, thickness)]
    profile = outer + (inner if thickness else [])
    return trimesh.creation.revolve(np.array(profile), sections=segments)


def export(mesh: Mesh, path: Path, kind: str) -> Path:
    """Writes a mesh as one of `FORMATS`; returns the path with its extension."""
    path = path.with_suffix("." + kind.rsplit(".", maxsplit=1)[-1])
    if kind == "gltf":
        for name, data in trimesh.exchange.gltf.export_gltf(trimesh.Scene(mesh)).items():
            (path if name == "model.gltf" else path.with_name(name)).write_bytes(data)
    elif kind == "ascii.stl":
        path.write_text(trimesh.exchange.stl.export_stl_ascii(mesh))
    elif kind == "ascii.ply":
        path.write_bytes(trimesh.exchange.ply.export_ply(mesh, encoding="ascii"))
    else:
        mesh.export(path)
    return path


def _joined(parts: list[Mesh]) -> Mesh:
    whole = trimesh.util.concatenate(parts)
    assert isinstance(whole, Mesh)
    return whole


def _letter() -> Mesh:
    outline = [(0, 0), (1, 0), (1, 0.25), (0.25, 0.25), (0.25, 0.5), (0.75, 0.5), (0.75, 0.75),
               (0.25, 0.75), (0.25, 1), (1, 1), (1, 1.25), (0, 1.25)]  # fmt: skip
    return trimesh.creation.extrude_polygon(Polygon(outline), 0.3, engine="manifold")


_BASES: list[Callable[[], Mesh]] = [
    trimesh.creation.box,
    lambda: trimesh.creation.torus(1.0, 0.35, major_sections=24, minor_sections=12),
    cup,
    lambda: cup(thickness=0.08),
    lambda: trimesh.creation.icosphere(subdivisions=3),
    _letter,
]


def _punched(mesh: Mesh, rng: Rng) -> Mesh:
    kept = rng.random(len(mesh.faces)) > rng.choice([0.02, 0.1, 0.4])
    kept[0] = True
    return Mesh(mesh.vertices, mesh.faces[kept], process=False)


def _flipped(mesh: Mesh, rng: Rng) -> Mesh:
    faces = mesh.faces.copy()
    turned = rng.random(len(faces)) < rng.choice([0.1, 0.5, 1.0])
    faces[turned] = faces[turned, ::-1]
    return Mesh(mesh.vertices, faces, process=False)


def _duplicated(mesh: Mesh, rng: Rng) -> Mesh:
    again = mesh.faces[rng.random(len(mesh.faces)) < 0.5]
    return Mesh(mesh.vertices, np.vstack([mesh.faces, again, again[:, ::-1]]), process=False)


def _not_finite(mesh: Mesh, rng: Rng) -> Mesh:
    vertices = mesh.vertices.copy()
    vertices[rng.integers(len(vertices)), rng.integers(3)] = rng.choice([np.nan, np.inf, -np.inf])
    return Mesh(vertices, mesh.faces, process=False)


def _soup(mesh: Mesh, rng: Rng) -> Mesh:
    count = int(rng.choice([1, 3, 40, 400]))
    faces = rng.integers(len(mesh.vertices), size=(count, 3))
    return Mesh(mesh.vertices, faces, process=False)


def _noisy(mesh: Mesh, rng: Rng) -> Mesh:
    """Intersects itself."""
    noise = rng.choice([0.01, 0.1, 0.5]) * mesh.extents.max() * rng.normal(size=mesh.vertices.shape)
    return Mesh(mesh.vertices + noise, mesh.faces, process=False)


def _squeezed(mesh: Mesh, rng: Rng) -> Mesh:
    scale = np.ones(3)
    scale[rng.integers(3)] = rng.choice([0.0, 1e-9, 1e-3, 0.02, 0.1])
    return Mesh(mesh.vertices * scale, mesh.faces, process=False)


def _with_sheet(mesh: Mesh, rng: Rng) -> Mesh:
    """Has a part of no thickness."""
    sheet = trimesh.creation.box(rng.uniform(0.5, 2) * mesh.extents)
    sheet.vertices = sheet.vertices * [1, 1, 0] + mesh.centroid
    return _joined([mesh, sheet])


def _resized(mesh: Mesh, rng: Rng) -> Mesh:
    return Mesh(mesh.vertices * rng.choice([1e-30, 1e-8, 1e6, 1e15, 1e200]), mesh.faces)


def _far(mesh: Mesh, rng: Rng) -> Mesh:
    return Mesh(mesh.vertices + rng.choice([1e2, 1e4, 1e8]) * mesh.extents.max(), mesh.faces)


def _several(mesh: Mesh, rng: Rng) -> Mesh:
    parts = [mesh.copy() for _ in range(int(rng.choice([2, 5, 30])))]
    for part in parts:
        part.apply_scale(rng.choice([0.005, 0.5, 1.0]))
        part.apply_translation(rng.normal(size=3) * mesh.extents.max())
    return _joined(parts)


def _touching(mesh: Mesh, rng: Rng) -> Mesh:
    """Two copies share a vertex, which merging makes one; boxes share edges or a face."""
    moved = mesh.copy()
    moved.apply_translation(
        mesh.vertices[rng.integers(len(mesh.vertices))] - mesh.vertices[rng.integers(8)]
    )
    return _joined([mesh, moved])


def _fins(mesh: Mesh, rng: Rng) -> Mesh:
    """More than two faces at an edge."""
    vertices = np.vstack([mesh.vertices, mesh.centroid + rng.normal(size=3) * mesh.extents.max()])
    chosen = mesh.faces[rng.integers(len(mesh.faces), size=5)]
    fins = np.column_stack([chosen[:, :2], np.full(5, len(mesh.vertices))])
    return Mesh(vertices, np.vstack([mesh.faces, fins]), process=False)


def _nested(mesh: Mesh, rng: Rng) -> Mesh:
    inner = mesh.copy()
    inner.vertices = (inner.vertices - mesh.centroid) * 0.5 + mesh.centroid
    if rng.random() < 0.5:
        inner.invert()
    return _joined([mesh, inner])


def _collapsed(mesh: Mesh, rng: Rng) -> Mesh:
    faces = mesh.faces.copy()
    chosen = rng.random(len(faces)) < 0.2
    faces[chosen, 1] = faces[chosen, 0]
    return Mesh(mesh.vertices, faces, process=False)


def _as_it_is(mesh: Mesh, rng: Rng) -> Mesh:
    del rng
    return mesh


_MESH_CHANGES: list[MeshChange] = [
    _punched, _flipped, _duplicated, _not_finite, _soup, _noisy, _squeezed, _with_sheet, _resized,
    _far, _several, _touching, _fins, _nested, _collapsed, _as_it_is,
]  # fmt: skip


def _bytes_changed(data: bytes, rng: Rng) -> bytes:
    changed = np.frombuffer(data, dtype=np.uint8).copy()
    where = rng.integers(len(changed), size=int(rng.choice([1, 10, 200])))
    changed[where] = rng.integers(256, size=len(where))
    return changed.tobytes()


def _header_changed(data: bytes, rng: Rng) -> bytes:
    changed = np.frombuffer(data, dtype=np.uint8).copy()
    where = rng.integers(min(len(changed), 200), size=5)
    changed[where] = rng.integers(256, size=5)
    return changed.tobytes()


def _truncated(data: bytes, rng: Rng) -> bytes:
    return data[: int(len(data) * rng.random())]


def _lengthened(data: bytes, rng: Rng) -> bytes:
    return data + rng.bytes(int(rng.integers(1, 1000)))


def _digits_changed(data: bytes, rng: Rng) -> bytes:
    """Numbers of text become others, which stay readable."""
    changed = np.frombuffer(data, dtype=np.uint8).copy()
    digits = np.flatnonzero((changed >= ord("0")) & (changed <= ord("9")))
    if len(digits):
        where = rng.choice(digits, size=30)
        changed[where] = rng.integers(ord("0"), ord("9") + 1, size=30)
    return changed.tobytes()


_BYTE_CHANGES: list[ByteChange] = [
    _bytes_changed, _header_changed, _truncated, _lengthened, _digits_changed,
]  # fmt: skip


def _empty(place: Path, rng: Rng) -> Path:
    path = place / f"empty.{rng.choice(['obj', 'stl', 'ply', 'glb', 'gltf', 'off'])}"
    path.write_bytes(b"")
    return path


def _noise(place: Path, rng: Rng) -> Path:
    path = place / f"noise.{rng.choice(['obj', 'stl', 'ply', 'glb', 'gltf', 'off'])}"
    path.write_bytes(rng.bytes(2000))
    return path


def _wrong_extension(place: Path, rng: Rng) -> Path:
    path = export(base_mesh(rng), place / "wrong", str(rng.choice(FORMATS)))
    return path.rename(path.with_suffix(str(rng.choice([".obj", ".stl", ".ply", ".glb", ".png"]))))


def _points_only(place: Path, rng: Rng) -> Path:
    path = place / "points.ply"
    trimesh.PointCloud(rng.random((50, 3))).export(path)
    return path


def _deep_gltf(place: Path, rng: Rng) -> Path:
    """Nodes in nodes, the last of which is the first again, or lists in lists."""
    depth = int(rng.choice([100, 5000]))
    path = place / "deep.gltf"
    if rng.random() < 0.5:
        path.write_text(
            '{"asset": {"version": "2.0"}, "extras": ' + "[" * depth + "]" * depth + "}"
        )
        return path
    export(trimesh.creation.box(), path, "gltf")
    header = json.loads(path.read_text())
    mesh_node = next(node for node in header["nodes"] if "mesh" in node)
    nodes = [{"children": [n + 1]} for n in range(depth)] + [{"mesh": mesh_node["mesh"]}]
    if rng.random() < 0.5:
        nodes[-1]["children"] = [0]
    header |= {"nodes": nodes, "scenes": [{"nodes": [0]}], "scene": 0}
    path.write_text(json.dumps(header))
    return path


def _missing_buffer(place: Path, rng: Rng) -> Path:
    path = export(base_mesh(rng), place / "alone.gltf", "gltf")
    for other in place.iterdir():
        if other != path:
            other.unlink()
    return path


_WHOLE_FILES: list[Callable[[Path, Rng], Path]] = [
    _empty, _noise, _wrong_extension, _points_only, _deep_gltf, _missing_buffer,
]  # fmt: skip


def _write(kind: int, place: Path, rng: Rng) -> Path:
    form = str(rng.choice(FORMATS))
    if kind < len(_MESH_CHANGES):
        return export(_MESH_CHANGES[kind](base_mesh(rng), rng), place / "mesh", form)
    kind -= len(_MESH_CHANGES)
    if kind < len(_BYTE_CHANGES):
        path = export(base_mesh(rng), place / "bytes", form)
        path.write_bytes(_BYTE_CHANGES[kind](path.read_bytes(), rng))
        return path
    return _WHOLE_FILES[kind - len(_BYTE_CHANGES)](place, rng)
