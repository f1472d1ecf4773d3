"""An object as a page to turn around in a browser."""

import gc

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform
from pydrake.perception import PointCloud

from keypush.objects.model import ObjectModel
from keypush.recording.page import dress_page
from keypush.recording.recorder import make_meshcat
from keypush.seeding import make_generator

_COM_COLOUR = Rgba(0.86, 0.10, 0.20, 1.0)
_POINT_COLOUR = Rgba(0.02, 0.04, 0.16, 1.0)
_EDGE_COLOUR = Rgba(0.10, 0.45, 0.20, 1.0)
_SUPPORT_COLOUR = Rgba(0.95, 0.55, 0.05, 1.0)
_LEGEND = (
    (_COM_COLOUR, "centre of mass"),
    (_POINT_COLOUR, "a cloud of 512 points"),
    (_EDGE_COLOUR, "faces that touch"),
    (_SUPPORT_COLOUR, "support polygon"),
)
_CLOUD_POINTS = 512


def object_page(model: ObjectModel, story: list[str]) -> str:
    """Returns a self-contained page that shows an object: what is seen, what touches, its COM.

    Args:
        model: upright, z up.
        story: paragraphs about it.
    """
    try:
        meshcat = make_meshcat()
        _draw(meshcat, model)
        title = model.name.replace("_", " ")
        return dress_page(meshcat.StaticHtml(), title, story, _LEGEND, time_bar=False)
    finally:
        gc.collect()  # Meshcat's port closes when it is found.


def _draw(meshcat: Meshcat, model: ObjectModel) -> None:
    size = model.bounding_radius
    for path in ("/Grid", "/Axes"):
        meshcat.SetProperty(path, "visible", False)
    meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=35.0))
    meshcat.SetCameraPose(size * np.array([2.4, -3.2, 2.2]), np.zeros(3))
    _mesh(meshcat, "/object/seen", model.visual.vertices, model.visual.faces, Rgba(*model.colour))
    meshcat.SetTriangleMesh(
        "/object/touches",
        model.vertices.T,
        model.faces.T.astype(np.int32),
        _EDGE_COLOUR,
        wireframe=True,
    )
    cloud = PointCloud(_CLOUD_POINTS)
    cloud.mutable_xyzs()[:] = model.surface_points(
        _CLOUD_POINTS, make_generator(0, 0, "object_page")
    ).T
    meshcat.SetObject("/cloud", cloud, 0.02 * size, _POINT_COLOUR)
    meshcat.SetObject("/centre_of_mass", Sphere(0.06 * size), _COM_COLOUR)
    meshcat.SetTransform("/centre_of_mass", RigidTransform(model.p_OoOcm_O))
    # Inside the object: seen through it, and drawn last to cover it.
    meshcat.SetProperty("/centre_of_mass/<object>", "material.depthTest", False)
    meshcat.SetProperty("/centre_of_mass/<object>", "material.transparent", True)
    meshcat.SetProperty("/centre_of_mass/<object>", "renderOrder", 1.0)
    polygon = np.column_stack(
        [model.support_polygon, np.full(len(model.support_polygon), -model.rest_height)]
    )
    meshcat.SetLine("/support", np.vstack([polygon, polygon[:1]]).T, 3.0, _SUPPORT_COLOUR)


def _mesh(
    meshcat: Meshcat,
    path: str,
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    colour: Rgba,
) -> None:
    """Draws every face with corners of its own, so that edges are not shaded away."""
    corners = np.asarray(vertices)[np.asarray(faces)].reshape(-1, 3)
    each = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    meshcat.SetTriangleMesh(path, corners.T, each.T, colour)
