"""Pictures of objects, rendered off screen by Drake's VTK engine."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from pydrake.common import MemoryFile
from pydrake.geometry import (
    Box,
    ClippingRange,
    ColorRenderCamera,
    GeometryInstance,
    InMemoryMesh,
    LightParameter,
    MakeRenderEngineVtk,
    Mesh,
    PerceptionProperties,
    RenderCameraCore,
    RenderEngineVtkParams,
    RenderLabel,
    Rgba,
    SceneGraph,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.sensors import CameraInfo

Colour = tuple[float, float, float]
Image = NDArray[np.uint8]

_FIELD_OF_VIEW = np.deg2rad(24.0)
_DISTANCE = 1.1 / np.sin(_FIELD_OF_VIEW / 2)
"""Of the camera from the middle, in radii of the mesh."""
_GROUND = (0.93, 0.93, 0.94)
_BACKGROUND = (1.0, 1.0, 1.0)
_SMOOTH_DEG = 35.0
"""Faces that meet at less than this angle are shaded as one smooth surface."""
_OVERSAMPLING = 2
_RENDERER = "vtk"


@dataclass(frozen=True)
class View:
    """Where the picture is taken from: the camera looks at the middle of the mesh."""

    azimuth_deg: float = -60.0
    """Direction of the camera about z, from x."""
    elevation_deg: float = 28.0
    """Height of the camera above the horizon."""
    size: tuple[int, int] = (320, 320)
    """Width and height in pixels."""


def render_mesh(
    mesh: trimesh.Trimesh,
    colour: Colour,
    view: View | None = None,
    dots: Sequence[tuple[NDArray[np.float64], float, Colour]] = (),
) -> Image:
    """Renders a mesh that stands on a light ground.

    Args:
        mesh: z up; the ground is put under its lowest point.
        colour: RGB in [0, 1].
        view: where from, and how large.
        dots: spheres to draw too: centre (3,), radius, colour.

    Returns:
        Picture (height, width, 3), RGB.
    """
    view = view or View()
    scene_graph = SceneGraph()
    parameters = RenderEngineVtkParams(default_clear_color=list(_BACKGROUND), lights=_lights())
    scene_graph.AddRenderer(_RENDERER, MakeRenderEngineVtk(parameters))
    source = scene_graph.RegisterSource("picture")
    middle, radius = _middle_and_radius(mesh)

    def add(shape: Shape, X_WG: RigidTransform, name: str, rgb: Colour) -> None:
        geometry = GeometryInstance(X_WG, shape, name)
        properties = PerceptionProperties()
        properties.AddProperty("phong", "diffuse", Rgba(*rgb, 1.0))
        properties.AddProperty("label", "id", RenderLabel.kDontCare)
        geometry.set_perception_properties(properties)
        scene_graph.RegisterAnchoredGeometry(source, geometry)

    add(_mesh_with_normals(mesh), RigidTransform(), "mesh", colour)
    ground = np.array([middle[0], middle[1], mesh.bounds[0, 2] - 0.002 * radius])
    add(Box(40 * radius, 40 * radius, 1e-4 * radius), RigidTransform(ground), "ground", _GROUND)
    for i, (centre, size, rgb) in enumerate(dots):
        add(Sphere(size), RigidTransform(np.asarray(centre, dtype=float)), f"dot_{i}", rgb)

    context = scene_graph.CreateDefaultContext()
    query: Any = scene_graph.get_query_output_port().Eval(context)
    distance = _DISTANCE * radius
    width, height = (_OVERSAMPLING * side for side in view.size)
    camera = ColorRenderCamera(
        RenderCameraCore(
            _RENDERER,
            CameraInfo(width, height, _FIELD_OF_VIEW),
            ClippingRange(0.01 * distance, 10 * distance),
            RigidTransform(),
        ),
        False,
    )
    X_WC = _camera_pose(middle, distance, view)
    image = query.RenderColorImage(camera, scene_graph.world_frame_id(), X_WC)
    return _smaller(np.asarray(image.data)[:, :, :3])


def pixel_of(point: NDArray[np.float64], mesh: trimesh.Trimesh, view: View) -> tuple[float, float]:
    """Returns where a point (3,) is in the picture of a mesh, in pixels from the upper left."""
    middle, radius = _middle_and_radius(mesh)
    p_CP = _camera_pose(middle, _DISTANCE * radius, view).inverse().multiply(p_BoQ_B=point)
    width, height = view.size
    focal = height / 2 / np.tan(_FIELD_OF_VIEW / 2)
    return (
        float(width / 2 + focal * p_CP[0] / p_CP[2]),
        float(height / 2 + focal * p_CP[1] / p_CP[2]),
    )


def _middle_and_radius(mesh: trimesh.Trimesh) -> tuple[NDArray[np.float64], float]:
    middle = np.asarray(mesh.bounds.mean(axis=0))
    return middle, float(np.linalg.norm(np.asarray(mesh.vertices) - middle, axis=1).max())


def _lights() -> list[LightParameter]:
    """In the camera's frame: a key light from its upper left, a fill light, one from above."""
    kinds = [([0.55, 0.75, 0.8], 0.95), ([-0.8, 0.25, 0.7], 0.55), ([0.0, 1.0, 0.15], 0.25)]
    return [
        LightParameter(type="directional", direction=towards, intensity=strength, frame="camera")
        for towards, strength in kinds
    ]


def _camera_pose(middle: NDArray[np.float64], distance: float, view: View) -> RigidTransform:
    """X_WC with Cz towards the middle and Cy down."""
    azimuth, elevation = np.deg2rad(view.azimuth_deg), np.deg2rad(view.elevation_deg)
    out = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    R_WC = RotationMatrix(np.column_stack([right, np.cross(-out, right), -out]))
    return RigidTransform(R_WC, middle + distance * out)


def _mesh_with_normals(mesh: trimesh.Trimesh) -> Mesh:
    """The mesh as OBJ text in memory; VTK wants normals, which are smooth up to an angle."""
    shaded = trimesh.graph.smooth_shade(mesh, angle=np.deg2rad(_SMOOTH_DEG))
    text = io.StringIO()
    for x, y, z in shaded.vertices:
        text.write(f"v {x:.7g} {y:.7g} {z:.7g}\n")
    for x, y, z in shaded.vertex_normals:
        text.write(f"vn {x:.4f} {y:.4f} {z:.4f}\n")
    for a, b, c in shaded.faces + 1:
        text.write(f"f {a}//{a} {b}//{b} {c}//{c}\n")
    file = MemoryFile(text.getvalue(), ".obj", "mesh.obj")
    return Mesh(mesh_data=InMemoryMesh(mesh_file=file), scale=1.0)


def _smaller(image: Image) -> Image:
    height, width = (side // _OVERSAMPLING for side in image.shape[:2])
    blocks = image.reshape(height, _OVERSAMPLING, width, _OVERSAMPLING, 3)
    return np.asarray(blocks.mean(axis=(1, 3)).round(), dtype=np.uint8)
