"""Shapes with sharp edges and whole bases, for which closed formulas hold."""

from functools import cache

import numpy as np
import trimesh
from shapely.geometry import Polygon

from keypush.objects.build import BuildOptions, build_asset
from keypush.objects.library import make_object
from keypush.objects.model import ObjectModel, scaled_model

# In parts of any size; an outline is (radius, height) from the axis around to the axis.
_BOXES = {"box": (10, 8, 6), "tall_box": (5, 5, 10)}
_TURNED = {
    "cylinder": [(0, 0), (3.5, 0), (3.5, 10), (0, 10)],
    "rod": [(0, 0), (1.5, 0), (1.5, 10), (0, 10)],
    "disc": [(0, 0), (5, 0), (5, 1.8), (0, 1.8)],
    "flask": [(0, 0), (1.95, 0), (1.95, 5.5), (0.9, 7.5), (0.9, 9.8), (0, 9.8)],
    "cup": [(0, 0), (3, 0), (3, 6.8), (2.6, 6.8), (2.6, 0.4), (0, 0.4)],
}
_L_PRISM = Polygon([(0, 0), (6, 0), (6, 2.5), (2.5, 2.5), (2.5, 6), (0, 6)])
EXACT = (*_BOXES, *_TURNED, "l_prism")


@cache
def exact_model(name: str) -> ObjectModel:
    """One of `EXACT`, with 0.1 kg and as large as the built-in objects."""
    mesh: trimesh.Trimesh
    if name in _BOXES:
        mesh = trimesh.creation.box(_BOXES[name])
    elif name in _TURNED:
        mesh = trimesh.creation.revolve(np.array(_TURNED[name], dtype=float), sections=48)
    else:
        mesh = trimesh.creation.extrude_polygon(_L_PRISM, 3.5)
    return scaled_model(build_asset(name, mesh, BuildOptions(up="z"), {}), 1.0)


def any_model(name: str) -> ObjectModel:
    """One of `EXACT`, or else a built-in object."""
    return exact_model(name) if name in EXACT else make_object(name)
