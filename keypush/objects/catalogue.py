"""The catalogue: named shapes, and which of them the network is trained on."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import trimesh

from keypush.errors import UserError
from keypush.objects import basic_shapes
from keypush.objects.model import ObjectModel, model_from_mesh

BOUNDING_RADIUS = 0.05
"""r_obj in m: radius of the bounding sphere about Oo at size_ratio 1."""
SPLITS = ("train", "unseen")


@dataclass(frozen=True)
class CatalogueEntry:
    """A named shape."""

    build: Callable[[float], trimesh.Trimesh]
    """Makes the mesh, upright, its sizes multiplied by the argument; any origin and size."""
    split: str
    """"train", or "unseen" for shapes that are never trained on."""
    colour: tuple[float, float, float]
    """RGB in [0, 1]."""


# Unseen are the bottle, near to what is trained on (round, but of varying radius and easily
# toppled), and the mug, far from it (hollow, with a handle, centre of mass off its axis). The
# L-block stays in training as the only shape there that is neither convex nor symmetric.
CATALOGUE: dict[str, CatalogueEntry] = {
    "box": CatalogueEntry(basic_shapes.box, "train", (0.85, 0.37, 0.22)),
    "tall_box": CatalogueEntry(basic_shapes.tall_box, "train", (0.93, 0.69, 0.13)),
    "can": CatalogueEntry(basic_shapes.can, "train", (0.76, 0.13, 0.28)),
    "bottle": CatalogueEntry(basic_shapes.bottle, "unseen", (0.20, 0.55, 0.35)),
    "mug": CatalogueEntry(basic_shapes.mug, "unseen", (0.16, 0.45, 0.70)),
    "l_block": CatalogueEntry(basic_shapes.l_block, "train", (0.49, 0.30, 0.62)),
    "candle": CatalogueEntry(basic_shapes.candle, "train", (0.95, 0.87, 0.70)),
    "disc": CatalogueEntry(basic_shapes.disc, "train", (0.35, 0.40, 0.45)),
}


def catalogue_names(split: str | None = None) -> list[str]:
    """Returns the names in the catalogue, or those of one split ("train" or "unseen").

    Raises:
        UserError: there is no such split.
    """
    if split is not None and split not in SPLITS:
        raise UserError(f"split is {split!r}; allowed: {', '.join(SPLITS)}")
    return [name for name, entry in CATALOGUE.items() if split in (None, entry.split)]


def parse_object_list(text: str) -> list[str]:
    """Reads "all", "train", "unseen" or names separated by commas.

    Raises:
        UserError: a name is not in the catalogue, or none is given.
    """
    if text in ("all", *SPLITS):
        return catalogue_names(None if text == "all" else text)
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise UserError(f"objects is {text!r}; allowed: all, {', '.join([*SPLITS, *CATALOGUE])}")
    for name in names:
        _entry(name)
    return list(dict.fromkeys(names))


def make_object(name: str, size_ratio: float = 1.0, mass: float = 0.1) -> ObjectModel:
    """Builds an object of the catalogue.

    Oo is the centre of the upright object's bounding box, and the bounding sphere about it
    has the radius `BOUNDING_RADIUS * size_ratio`.

    Raises:
        UserError: the name is not in the catalogue.
    """
    entry = _entry(name)
    radius = BOUNDING_RADIUS * size_ratio
    # The widths of the contact faces are absolute, so the shape is built at its true size.
    mesh = entry.build(radius / _radius(entry.build(1.0)))
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    return model_from_mesh(
        name, mesh, size_ratio=size_ratio, mass=mass, colour=(*entry.colour, 1.0)
    )


def _entry(name: str) -> CatalogueEntry:
    if name not in CATALOGUE:
        raise UserError(f"object {name!r} is not in the catalogue; allowed: {', '.join(CATALOGUE)}")
    return CATALOGUE[name]


def _radius(mesh: trimesh.Trimesh) -> float:
    return float(np.linalg.norm(mesh.vertices - mesh.bounds.mean(axis=0), axis=1).max())
