"""`object.json`: what it says of an asset, checked, since somebody may have edited it."""

import json
import reprlib
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RotationMatrix

from keypush.objects.resting import RestingPose

Array = NDArray[np.float64]

FORMAT = 1
_ROUNDING = 1e-9
"""Relative error that an inertia may have for having been written."""


def read_description(text: str) -> dict[str, Any]:
    """Returns the fields of an `ObjectAsset` that its `object.json` holds.

    Raises:
        ValueError: it is no JSON, or a field is missing or holds what no object can have; names it.
    """
    found = _mapping(json.loads(text), "the top level")
    if _field(found, "format") != FORMAT:
        raise _wrong("format", found["format"], str(FORMAT))
    provenance = _mapping(_field(found, "provenance"), "provenance")
    _positive(_field(provenance, "volume", "provenance."), "provenance.volume")
    return {
        "colour": _colour(_field(found, "colour")),
        "mass": _positive(_field(found, "mass"), "mass"),
        "p_OoOcm_O": _numbers(_field(found, "centre_of_mass"), "centre_of_mass", (3,)),
        "inertia_per_mass": _inertia(_field(found, "inertia_per_mass")),
        "poses": _poses(_field(found, "resting_poses")),
        "provenance": provenance,
    }


def _poses(found: Any) -> tuple[RestingPose, ...]:
    if not (isinstance(found, list) and found):
        raise _wrong("resting_poses", found, "a list of one or more")
    return tuple(_pose(pose, f"resting_poses[{k}]") for k, pose in enumerate(found))


def _pose(found: Any, name: str) -> RestingPose:
    pose, prefix = _mapping(found, name), f"{name}."
    wxyz = _numbers(_field(pose, "quaternion_wxyz", prefix), f"{prefix}quaternion_wxyz", (4,))
    length = np.linalg.norm(wxyz)
    if not 0 < length < np.inf:
        raise _wrong(f"{prefix}quaternion_wxyz", wxyz.tolist(), "a quaternion of length 1")
    height, angle, share = (
        _positive(_field(pose, field, prefix), f"{prefix}{field}")
        for field in ("height", "tipping_angle", "share")
    )
    return RestingPose(RotationMatrix(Quaternion(wxyz / length)), height, angle, share)


def _colour(found: Any) -> tuple[float, float, float]:
    red, green, blue = values = _numbers(found, "colour", (3,)).tolist()
    if not all(0 <= value <= 1 for value in values):
        raise _wrong("colour", found, "three numbers from 0 to 1")
    return red, green, blue


def _inertia(found: Any) -> Array:
    """What a body can have: no axis has a moment of inertia above the sum of the other two's."""
    inertia = _numbers(found, "inertia_per_mass", (3, 3))
    low, middle, high = np.linalg.eigvalsh(inertia)
    symmetric = np.allclose(inertia, inertia.T, rtol=0, atol=_ROUNDING * high)
    if not (symmetric and low > 0 and high <= (1 + _ROUNDING) * (low + middle)):
        raise _wrong("inertia_per_mass", found, "the inertia of a body")
    return inertia


def _positive(found: Any, name: str) -> float:
    number = float(_numbers(found, name, ()))
    if number <= 0:
        raise _wrong(name, found, "a number above 0")
    return number


def _numbers(found: Any, name: str, shape: tuple[int, ...]) -> Array:
    numbers = np.asarray(found)  # raises a ValueError for lists of several lengths
    if numbers.dtype.kind not in "if" or numbers.shape != shape or not np.isfinite(numbers).all():
        raise _wrong(name, found, " x ".join(map(str, shape)) + " numbers" if shape else "a number")
    return numbers.astype(np.float64)


def _mapping(found: Any, name: str) -> dict[str, Any]:
    if not isinstance(found, dict):
        raise _wrong(name, found, "a mapping")
    return found


def _field(found: dict[str, Any], name: str, prefix: str = "") -> Any:
    if name not in found:
        raise ValueError(f"{prefix}{name} is missing")
    return found[name]


def _wrong(name: str, found: Any, expected: str) -> ValueError:
    return ValueError(f"{name} is {reprlib.repr(found)} and not {expected}")
