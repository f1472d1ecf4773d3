"""Objects in words and tables."""

from typing import Any

import numpy as np
from rich.table import Table

from keypush.errors import UserError
from keypush.objects.asset import ObjectAsset
from keypush.objects.catalogue import catalogue
from keypush.objects.library import USER_GROUP, load_object, object_names

_SPLITS = {
    "train": "a built-in object that is trained on",
    "id": "a built-in test object, like those that are trained on",
    "ood": "a built-in test object, unlike those that are trained on",
    USER_GROUP: "an object that was added",
}


def split_of(name: str) -> str:
    """Returns the split of a built-in object, "user" for one that was added."""
    entry = catalogue().get(name)
    return USER_GROUP if entry is None else entry.split


def describe_objects() -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Describes all objects that can be read.

    Returns:
        Figures by name, lengths in m, mass in kg, angles in deg; and what is wrong with the others.
    """
    described, unreadable = {}, []
    for name in object_names():
        try:
            described[name] = _describe(load_object(name))
        except UserError as error:
            unreadable.append(str(error))
    return described, unreadable


def _describe(asset: ObjectAsset) -> dict[str, Any]:
    entry = catalogue().get(asset.name)
    return {
        "split": split_of(asset.name),
        "ablation": "" if entry is None else entry.ablation,
        "size": [round(float(extent), 4) for extent in asset.visual.extents],
        "mass": asset.mass,
        "volume": float(asset.provenance["volume"]),
        "faces_seen": len(asset.visual.faces),
        "faces_touching": len(asset.collision.faces),
        "stable_poses": len(asset.poses),
        "tipping_angle_deg": float(np.rad2deg(asset.poses[0].tipping_angle)),
    }


def objects_table(described: dict[str, dict[str, Any]]) -> Table:
    """Lays out one line per object."""
    table = Table(title=f"{len(described)} objects", title_justify="left")
    table.add_column("object")
    table.add_column("split")
    for heading in ("size, mm", "mass, g", "faces", "poses", "tips at"):
        table.add_column(heading, justify="right")
    for name, line in described.items():
        validates = line["ablation"] == "validation"
        table.add_row(
            name,
            line["split"] + ("*" if validates else ""),
            " x ".join(f"{1000 * extent:.0f}" for extent in line["size"]),
            f"{1000 * line['mass']:.0f}",
            str(line["faces_touching"]),
            str(line["stable_poses"]),
            f"{line['tipping_angle_deg']:.0f}°",
        )
    table.caption = "* for validation in the ablation; faces: those that touch"
    return table


def tell_object(asset: ObjectAsset) -> list[str]:
    """Tells about an object in a few lines."""
    figures = _describe(asset)
    x, y, z = (100 * extent for extent in figures["size"])
    com = ", ".join(f"{1000 * value:z.1f}" for value in asset.p_OoOcm_O)
    kind = _SPLITS[figures["split"]]
    touching = f"{figures['faces_touching']} faces touch, {figures['faces_seen']} are seen"
    poses = figures["stable_poses"]
    stands = f"It stands in {poses} way{'s' if poses > 1 else ''}"
    return [
        f"{asset.name}, {kind}: {x:.1f} x {y:.1f} x {z:.1f} cm, {1000 * asset.mass:.0f} g.",
        f"{touching}; centre of mass at ({com}) mm from the middle.",
        f"{stands}; upright it tips at {figures['tipping_angle_deg']:.0f} degrees.",
    ]
