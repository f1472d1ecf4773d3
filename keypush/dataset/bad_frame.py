"""Finds frames whose numbers cannot be what they should."""

from collections.abc import Iterable
from typing import NamedTuple

import pyarrow as pa

from keypush.dataset.arrays import not_finite, to_array
from keypush.dataset.features import Feature
from keypush.dataset.poses import POSES, QUATERNION_ERROR, quaternion_errors


class BadFrame(NamedTuple):
    """A frame and what is wrong with it."""

    row: int
    """Of the table."""
    found: str
    """The field and what it holds."""
    allowed: str


def find_bad_frame(frames: pa.Table, features: Iterable[Feature]) -> BadFrame | None:
    """Returns the first frame with numbers that are not finite or a pose that is none.

    Args:
        frames: some fields of frames.
        features: fields to look at, as far as they are there.
    """
    for feature in features:
        if feature.name not in frames.column_names:
            continue
        values = to_array(frames[feature.name])
        bad = not_finite(values, may_be_nan=feature.may_be_nan).any(axis=1)
        allowed = f"finite numbers{', or NaN in all of them' if feature.may_be_nan else ''}"
        if feature.name in POSES and not bad.any():
            bad = quaternion_errors(values) > QUATERNION_ERROR
            allowed = "quaternions of norm 1"
        if bad.any():
            row = int(bad.argmax())
            return BadFrame(row, f"{feature.name} is {values[row].tolist()}", allowed)
    return None
