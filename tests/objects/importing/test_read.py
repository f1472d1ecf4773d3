"""Reading: six formats, scenes, colours, and files that are refused with one line."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from keypush.errors import UserError
from keypush.objects.importing.process import Importer
from keypush.objects.importing.read import check_file, read_mesh
from tests.objects.importing.mutate import FORMATS, export


def sphere() -> trimesh.Trimesh:
    mesh: trimesh.Trimesh = trimesh.creation.icosphere(subdivisions=2, radius=3.0)
    mesh.apply_translation([10.0, -2.0, 1.0])
    return mesh


def textured(image: Image.Image | None) -> trimesh.Trimesh:
    mesh = sphere()
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=image, baseColorFactor=[255, 255, 255, 255]
    )
    uv = np.random.default_rng(0).random((len(mesh.vertices), 2))
    mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    return mesh


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_gives_the_same_mesh(form: str, tmp_path: Path) -> None:
    mesh = sphere()
    read = read_mesh(export(mesh, tmp_path / "sphere", form)).mesh
    assert len(read.faces) == len(mesh.faces)
    assert read.volume == pytest.approx(mesh.volume, rel=1e-5)
    np.testing.assert_allclose(read.bounds, mesh.bounds, atol=1e-5)


def test_a_text_stl_may_be_written_in_capitals(tmp_path: Path) -> None:
    path = export(sphere(), tmp_path / "sphere", "ascii.stl")
    path.write_text(path.read_text().upper())
    assert read_mesh(path).mesh.volume == pytest.approx(sphere().volume, rel=1e-5)


def test_the_extension_may_be_upper_case(tmp_path: Path) -> None:
    path = export(sphere(), tmp_path / "sphere", "stl").rename(tmp_path / "SPHERE.STL")
    assert len(read_mesh(path).mesh.faces) == 320


def test_every_geometry_of_a_scene_is_where_it_stands(tmp_path: Path) -> None:
    """A box twice, once mirrored, and a sphere under a turned node."""
    scene = trimesh.Scene()
    box = trimesh.creation.box([2.0, 1.0, 1.0])
    scene.add_geometry(box, geom_name="box", transform=np.diag([1.0, 1.0, 1.0, 1.0]))
    moved = trimesh.transformations.translation_matrix([10.0, 0.0, 0.0]) @ np.diag([-1, 1, 1, 1])
    scene.graph.update("other", matrix=moved, geometry="box")
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, [0, 0, 1], [0, 0, 0])
    turned[:3, 3] = [0.0, 5.0, 0.0]
    tall = trimesh.creation.box([4.0, 1.0, 1.0])
    scene.add_geometry(tall, geom_name="tall", transform=turned)
    path = tmp_path / "scene.glb"
    scene.export(path)
    mesh = read_mesh(path).mesh
    assert len(mesh.faces) == 36
    assert mesh.volume == pytest.approx(2.0 + 2.0 + 4.0)
    np.testing.assert_allclose(mesh.bounds, [[-1.0, -0.5, -0.5], [11.0, 7.0, 0.5]], atol=1e-6)


def test_what_is_no_mesh_in_a_scene_is_left_out(tmp_path: Path) -> None:
    scene = trimesh.Scene([sphere(), trimesh.PointCloud(np.zeros((5, 3)))])
    scene.export(tmp_path / "scene.glb")
    assert len(read_mesh(tmp_path / "scene.glb").mesh.faces) == 320


def test_the_colour_of_a_texture_is_its_average(tmp_path: Path) -> None:
    image = Image.new("RGB", (8, 8), (255, 0, 0))
    image.paste((0, 0, 255), (0, 0, 8, 4))
    path = tmp_path / "ball.glb"
    textured(image).export(path)
    colour = read_mesh(path).colour
    np.testing.assert_allclose(np.array(colour), [0.5, 0.0, 0.5], atol=0.01)


def test_the_colour_of_vertices_is_their_average(tmp_path: Path) -> None:
    mesh = sphere()
    colours = np.tile(np.array([[0, 255, 0, 255]], dtype=np.uint8), (len(mesh.vertices), 1))
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=colours)
    mesh.export(tmp_path / "ball.ply")
    assert read_mesh(tmp_path / "ball.ply").colour == (0.0, 1.0, 0.0)
    assert read_mesh(export(sphere(), tmp_path / "plain", "stl")).colour is None


def test_a_missing_material_or_texture_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "ball.obj"
    textured(Image.new("RGB", (4, 4), (9, 9, 9))).export(path)
    files = [file for file in tmp_path.iterdir() if file != path]
    assert len(files) == 2
    for file in sorted(files):
        file.unlink()
        assert len(read_mesh(path).mesh.faces) == 320


def test_a_broken_texture_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "ball.obj"
    noise = np.random.default_rng(0).integers(256, size=(64, 64, 3), dtype=np.uint8)
    textured(Image.fromarray(noise)).export(path)
    picture = next(file for file in tmp_path.iterdir() if file.suffix in (".png", ".jpeg"))
    picture.write_bytes(picture.read_bytes()[:500])
    file = read_mesh(path)
    assert len(file.mesh.faces) == 320
    assert file.colour is None


def refusal(path: Path, importer: Importer) -> str:
    with pytest.raises(UserError) as caught:
        importer.import_mesh(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert len(text.splitlines()) == 1
    return text.removeprefix(f"{path}: ")


def test_paths_that_are_no_files_are_refused(importer: Importer, tmp_path: Path) -> None:
    formats = "obj, stl, ply, glb, gltf, off"
    assert refusal(tmp_path / "none.obj", importer) == (
        f"No such file or directory; expected a mesh file ({formats})"
    )
    folder = tmp_path / "folder.obj"
    folder.mkdir()
    assert refusal(folder, importer) == f"a folder; expected a mesh file ({formats})"
    pipe = tmp_path / "pipe.obj"
    os.mkfifo(pipe)
    assert refusal(pipe, importer) == f"not a file; expected a mesh file ({formats})"
    assert "name too long" in refusal(tmp_path / ("x" * 300 + ".obj"), importer)
    other = tmp_path / "thing.step"
    other.write_text("x")
    assert refusal(other, importer) == f"unknown extension '.step'; allowed: {formats}"


def test_an_empty_or_huge_file_is_refused(importer: Importer, tmp_path: Path) -> None:
    path = tmp_path / "thing.stl"
    path.touch()
    assert refusal(path, importer) == "the file is empty; expected a mesh"
    with path.open("wb") as file:
        file.truncate(600_000_000)
    with pytest.raises(UserError, match="600 MB; allowed: at most 500 MB"):
        check_file(path)


def test_too_many_faces_are_refused(tmp_path: Path) -> None:
    """A small file names one geometry 7000 times."""
    scene = trimesh.Scene()
    for number in range(7000):
        pose = trimesh.transformations.translation_matrix([number, 0, 0])
        if number == 0:
            scene.add_geometry(sphere(), geom_name="ball", transform=pose)
        else:
            scene.graph.update(f"node{number}", matrix=pose, geometry="ball")
    path = tmp_path / "many.glb"
    scene.export(path)
    with pytest.raises(UserError, match="2240000 faces; allowed: at most 2000000"):
        read_mesh(path)


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "glb", "gltf", "off"])
def test_other_contents_are_refused(suffix: str, importer: Importer, tmp_path: Path) -> None:
    path = tmp_path / f"thing.{suffix}"
    path.write_bytes(np.random.default_rng(0).bytes(1000))
    assert refusal(path, importer).startswith(
        ("cannot be read as ", "no faces in it", "not an STL")
    )


def test_a_point_cloud_is_refused(importer: Importer, tmp_path: Path) -> None:
    path = tmp_path / "points.ply"
    trimesh.PointCloud(np.random.default_rng(0).random((50, 3))).export(path)
    expected = "no faces in it (PointCloud); expected a mesh of triangles"
    assert refusal(path, importer) == expected


# trimesh, as it writes such a file.
@pytest.mark.filterwarnings("ignore:invalid value")
def test_vertices_that_are_not_finite_are_refused(importer: Importer, tmp_path: Path) -> None:
    mesh = sphere()
    mesh.vertices[3, 1] = np.nan
    mesh.vertices[5, 2] = np.inf
    for form in ("stl", "ply", "off"):
        path = export(mesh, tmp_path / form, form)
        assert "are NaN or infinite; expected finite numbers" in refusal(path, importer)


def test_a_vertex_that_is_missing_is_refused(importer: Importer, tmp_path: Path) -> None:
    path = export(trimesh.creation.box(), tmp_path / "thing", "ascii.ply")
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:-1], "3 1 2 9"]))
    assert refusal(path, importer) == "a face names vertex 9; allowed: 0 to 7"


def test_a_missing_buffer_is_refused(importer: Importer, tmp_path: Path) -> None:
    path = export(sphere(), tmp_path / "thing", "gltf")
    buffer = tmp_path / "gltf_buffer_1.bin"
    buffer.unlink()
    assert refusal(path, importer) == f"it names a file that is not there: {buffer.name}"


def test_files_elsewhere_are_not_read(importer: Importer, tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    path = export(sphere(), folder / "thing", "gltf")
    buffer = folder / "gltf_buffer_1.bin"
    buffer.rename(tmp_path / buffer.name)
    for uri in (f"../{buffer.name}", "http://localhost/a.bin"):
        path.write_text(path.read_text().replace(buffer.name, uri))
        assert len(refusal(path, importer)) < 400


def test_a_broken_gltf_is_not_mistaken_for_its_neighbour(
    importer: Importer, tmp_path: Path
) -> None:
    export(sphere(), tmp_path / "model", "gltf")
    path = tmp_path / "broken.gltf"
    path.write_text('{"asset": ')
    assert refusal(path, importer).startswith("cannot be read as glTF: Expecting value")


@pytest.mark.parametrize("form", ["obj", "off", "stl", "ascii.stl", "ply", "ascii.ply"])
def test_names_may_be_in_another_encoding(form: str, tmp_path: Path) -> None:
    path = export(sphere(), tmp_path / "thing", form)
    data, name = path.read_bytes(), "Größe".encode("latin-1")
    if form == "stl":
        data = name.ljust(80) + data[80:]
    elif form == "ascii.stl":
        data = b"solid " + name + data[data.index(b"\n") :]
    else:
        lines = data.split(b"\n")
        lines.insert(
            2 if form.endswith("ply") else 1,
            (b"comment " if form.endswith("ply") else b"# ") + name,
        )
        data = b"\n".join(lines)
    path.write_bytes(data)
    assert read_mesh(path).mesh.volume == pytest.approx(sphere().volume, rel=1e-5)


def test_a_file_that_needs_too_much_memory_is_refused(importer: Importer, tmp_path: Path) -> None:
    """Two thousand million vertices, all of them zero, take a line of glTF."""
    header = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 2_000_000_000, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 3}],
        "buffers": [{"byteLength": 3, "uri": "data:application/octet-stream;base64,AAAA"}],
    }
    path = tmp_path / "zeros.gltf"
    path.write_text(json.dumps(header))
    assert refusal(path, importer) == "reading it needs more than 8 GB of memory"


def test_a_binary_stl_may_be_longer_but_not_shorter(importer: Importer, tmp_path: Path) -> None:
    path = export(sphere(), tmp_path / "thing", "stl")
    data = path.read_bytes()
    path.write_bytes(data + bytes(100))
    assert len(read_mesh(path).mesh.faces) == 320
    path.write_bytes(data[:-500])
    assert refusal(path, importer) == (
        "not an STL file, or cut off: 15584 bytes; its header says 320 faces, which take 16084"
    )
    path.write_bytes(bytes(84))
    assert "no faces in it" in refusal(path, importer)


@pytest.mark.parametrize(
    ("scale", "shift", "text"),
    [
        (1e-12, 0.0, "its size is 1.04e-11; allowed: 1e-09 to 1e+09"),
        (1e12, 0.0, "its size is 1.04e+13; allowed: 1e-09 to 1e+09"),
        (0.0, 1.0, "its size is 0; allowed: 1e-09 to 1e+09"),
        (1.0, 1e9, "lies 1e+09 from the origin; allowed: at most 1e+06 times its size"),
    ],
)
def test_absurd_sizes_and_places_are_refused(
    scale: float, shift: float, text: str, importer: Importer, tmp_path: Path
) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=3.0)
    mesh.vertices = mesh.vertices * scale + shift
    path = tmp_path / "thing.ply"
    # As double precision, unlike what trimesh writes.
    header = (
        "ply\nformat ascii 1.0\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\n"
        f"property double z\nelement face {len(mesh.faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    vertices = "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist())
    faces = "".join(f"3 {a} {b} {c}\n" for a, b, c in mesh.faces.tolist())
    path.write_text(header + vertices + faces)
    assert text in refusal(path, importer)


def test_a_sheet_is_refused_with_its_thickness(importer: Importer, tmp_path: Path) -> None:
    allowed = "allowed: at least 1% of its size"
    card = export(trimesh.creation.box([3.0, 4.0, 0.02]), tmp_path / "card", "ply")
    assert refusal(card, importer) == f"it is flat, 0.02 thick and 5 across; {allowed}"
    sheet = export(
        trimesh.Trimesh([[0, 0, 0], [3, 0, 0], [3, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]]),
        tmp_path / "sheet",
        "obj",
    )
    assert refusal(sheet, importer) == f"it is flat, 0 thick and 5 across; {allowed}"
    turned = trimesh.creation.box([3.0, 4.0, 0.02])
    turned.apply_transform(trimesh.transformations.rotation_matrix(0.7, [1.0, 2.0, 3.0]))
    assert "0.02 thick" in refusal(export(turned, tmp_path / "turned", "ply"), importer)


def test_a_line_is_refused(importer: Importer, tmp_path: Path) -> None:
    path = tmp_path / "line.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n")
    assert "it is flat, 0 thick and 2 across" in refusal(path, importer)
