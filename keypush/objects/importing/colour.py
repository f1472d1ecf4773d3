"""The main colour of a mesh."""

from typing import Any

import numpy as np
import trimesh
from PIL import Image

from keypush.objects.importing.result import Colour


def main_colour(mesh: trimesh.Trimesh) -> Colour | None:
    """Returns the average colour of a mesh's texture, vertices or faces, or None."""
    visual: Any = mesh.visual
    if not visual.defined:
        return None
    if visual.kind == "texture":
        return _material_colour(visual.material)
    if visual.kind == "vertex":
        return _colour(np.asarray(visual.vertex_colors).mean(axis=0))
    if visual.kind == "face":
        return _colour(np.asarray(visual.face_colors).mean(axis=0))
    return None


def average_colour(colours: list[tuple[Colour | None, float]]) -> Colour | None:
    """Returns the average of the colours that there are, each with its weight."""
    known = [(colour, weight) for colour, weight in colours if colour is not None and weight > 0]
    if not known:
        return None
    weights = np.array([weight for _, weight in known])
    return _colour(255 * weights @ np.array([colour for colour, _ in known]) / weights.sum())


def _material_colour(material: Any) -> Colour | None:
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if isinstance(image, Image.Image):
        try:
            pixel = image.convert("RGB").resize((1, 1), Image.Resampling.BOX)
        except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
            # What Pillow raises about a broken picture, and colours are only for looks.
            return None
        return _colour(np.asarray(pixel, dtype=float)[0, 0])
    if material is None or not hasattr(material, "main_color"):
        return None
    return _colour(np.asarray(material.main_color, dtype=float))


def _colour(values: Any) -> Colour | None:
    """Turns values of 0 to 255 into a colour, or None if they are none."""
    if np.shape(values)[0] < 3 or not np.isfinite(values[:3]).all():
        return None
    red, green, blue = (float(v) for v in np.clip(np.asarray(values[:3]) / 255, 0, 1))
    return red, green, blue
