"""The catalogue of built-in objects and their splits, as `catalogue.yaml` lists them."""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import yaml

from keypush.errors import UserError

if TYPE_CHECKING:
    import trimesh

_FILE = Path(__file__).with_name("catalogue.yaml")

SPLITS = ("train", "id", "ood")
"""Trained on; like those, yet never trained on; unlike all of them."""
GROUPS = (*SPLITS, "unseen", "ablation_train", "ablation_validation", "all")
"""Names for several objects: the splits, id and ood together, the two parts of train, all."""


@dataclass(frozen=True)
class CatalogueEntry:
    """A built-in object."""

    name: str
    split: str
    """One of `SPLITS`."""
    ablation: str
    """Within train: "train" or "validation" in the ablation; else empty."""
    generator: str
    """module.function below `keypush.objects.generators`."""
    parameters: Mapping[str, float]
    """Keyword arguments of the generator."""
    colour: tuple[float, float, float]
    """RGB in [0, 1]."""

    def generate(self) -> "trimesh.Trimesh":
        """Makes the closed mesh: z up, standing on z = 0, of any size."""
        generators = "keypush.objects.generators"
        module, function = self.generator.split(".")
        generator = getattr(importlib.import_module(f"{generators}.{module}"), function)
        # Not imported above: only who makes objects anew needs manifold3d.
        to_mesh = importlib.import_module("keypush.objects.manifolds").to_mesh
        return cast("trimesh.Trimesh", to_mesh(generator(**self.parameters)))


@cache
def catalogue() -> Mapping[str, CatalogueEntry]:
    """Returns the entries by name, in the catalogue's order."""
    listed = yaml.safe_load(_FILE.read_text(encoding="utf-8"))
    return {name: _entry(name, found) for name, found in listed.items()}


def _entry(name: str, found: Mapping[str, Any]) -> CatalogueEntry:
    default = "train" if found["split"] == "train" else ""
    return CatalogueEntry(
        name=name,
        split=found["split"],
        ablation=found.get("ablation", default),
        generator=found["generator"],
        parameters=found["parameters"],
        colour=cast("tuple[float, float, float]", tuple(found["colour"])),
    )


def catalogue_names(group: str = "all") -> list[str]:
    """Returns the names of one of `GROUPS`, in the catalogue's order.

    Raises:
        UserError: there is no such group.
    """
    if group not in GROUPS:
        raise UserError(f"group is {group!r}; allowed: {', '.join(GROUPS)}")
    return [entry.name for entry in catalogue().values() if _belongs(entry, group)]


def _belongs(entry: CatalogueEntry, group: str) -> bool:
    if group == "unseen":
        return entry.split != "train"
    if group.startswith("ablation_"):
        return entry.ablation == group.removeprefix("ablation_")
    return group in ("all", entry.split)
