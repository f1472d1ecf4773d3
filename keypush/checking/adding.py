"""Adds a mesh file to the user's objects."""

import math
from dataclasses import replace
from pathlib import Path

from shapely.errors import ShapelyError

from keypush import __version__
from keypush.checking.object_checks import Check, check_object
from keypush.errors import UserError, one_line
from keypush.objects.asset import ObjectAsset, write_asset
from keypush.objects.build import BuildOptions, build_asset
from keypush.objects.importing.process import import_mesh
from keypush.objects.library import check_new_name, user_objects_dir

_RANGES = {"scale": (0.02, 0.5), "mass": (0.001, 10.0), "density": (1.0, 25_000.0)}
"""Allowed diameters in m, masses in kg, densities in kg/m^3."""


def add_object_file(
    file: Path, name: str, options: BuildOptions | None = None
) -> tuple[ObjectAsset, Path]:
    """Reads a mesh file, mends it, checks it and stores it as an object, whole or not at all.

    Args:
        file: OBJ, STL, PLY, GLB, glTF or OFF.
        name: of the new object.
        options: what the file does not say; a colour that it has counts.

    Returns:
        The object and the folder in which it is stored.

    Raises:
        UserError: the name is taken or misspelled, an option is out of range, or the file
            holds nothing that can be pushed or that passes the checks.
    """
    options = options or BuildOptions()
    check_new_name(name)
    _check_options(options)
    found = import_mesh(file)
    if found.colour is not None:
        options = replace(options, colour=found.colour)
    provenance = {
        "file": file.name,
        "sha256": found.sha256,
        "keypush": __version__,
        "notes": list(found.notes),
    }
    try:
        asset = build_asset(name, found.solid, options, provenance)
        _check_mass(asset, options)
        failed = [_told(check) for check in check_object(asset).values() if not check.ok]
    except (ArithmeticError, LookupError, RuntimeError, ValueError, ShapelyError) as error:
        # Geometry that nobody foresaw: the file is refused, and the cause stays attached.
        raise UserError(f"{file}: no object can be made of it: {one_line(error)}") from error
    if failed:
        raise UserError(
            f"{file}: what became of it could not be pushed reliably: wrong are {'; '.join(failed)}"
        )
    folder = user_objects_dir() / name
    write_asset(asset, folder)
    return asset, folder


def _told(check: Check) -> str:
    measured = "" if check.value is None else f" ({check.value:.3g}, limit {check.limit:.3g})"
    return f"{check.text}{measured}"


def _check_mass(asset: ObjectAsset, options: BuildOptions) -> None:
    """Holds what a density gives to the range of masses."""
    low, high = _RANGES["mass"]
    if not low <= asset.mass <= high:
        raise UserError(
            f"--density {options.density} makes it {asset.mass:.3g} kg; allowed: {low:g} to "
            f"{high:g} kg"
        )


def _check_options(options: BuildOptions) -> None:
    """Raises a UserError that names the option, what it holds and what is allowed."""
    values = {"scale": options.diameter, "mass": options.mass, "density": options.density}
    for name, value in values.items():
        low, high = _RANGES[name]
        if value is not None and not (math.isfinite(value) and low <= value <= high):
            raise UserError(f"--{name} is {value!r}; allowed: {low:g} to {high:g}")
    if options.mass is not None and options.density is not None:
        raise UserError("--mass and --density are both given; allowed: one of them")
