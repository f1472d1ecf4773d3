"""What was varied between episodes, in words and in an order."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from keypush.evaluation.conditions import number_text
from keypush.scenario import NoiseConfig, PlannerConfig

VARIED = ("size_ratio", "com_shift", "cloud_deviation", "push_speed")
"""Columns of a record that a condition is made of."""
_CLOUD_DEVIATION = NoiseConfig().cloud_deviation
_PUSH_SPEED = PlannerConfig().push_speed


class Family(StrEnum):
    """Kinds of conditions."""

    NOMINAL = "nominal"
    SIZE = "other sizes"
    SHIFT = "shifted centre of mass"
    OTHER = "other conditions"


@dataclass(frozen=True, order=True)
class Condition:
    """How episodes differ from nominal ones; the defaults are nominal."""

    cloud_deviation: float = _CLOUD_DEVIATION
    """Of each coordinate of the cloud in m."""
    push_speed: float = _PUSH_SPEED
    """m/s."""
    com_shift: float = 0.0
    """Horizontal, in m."""
    size_ratio: float = 1.0
    """Relative to the object's own size."""
    varied_size: bool = False
    """Whether every episode has a size of its own; `size_ratio` is then nominal."""

    @property
    def family(self) -> Family:
        """The kind that it belongs to; two things varied at once are OTHER."""
        nominal = Condition()
        if self == nominal:
            return Family.NOMINAL
        if self == Condition(size_ratio=self.size_ratio):
            return Family.SIZE
        if self == Condition(com_shift=self.com_shift):
            return Family.SHIFT
        return Family.OTHER

    @property
    def words(self) -> str:
        """What differs from nominal."""
        nominal = Condition()
        parts = []
        if self.size_ratio != nominal.size_ratio:
            parts.append(f"size {number_text(self.size_ratio)}")
        if self.varied_size:
            parts.append("varied size")
        if self.com_shift != nominal.com_shift:
            parts.append(f"COM shifted {number_text(1000 * self.com_shift)} mm")
        if self.cloud_deviation != nominal.cloud_deviation:
            parts.append(f"cloud noise {number_text(1000 * self.cloud_deviation)} mm")
        if self.push_speed != nominal.push_speed:
            parts.append(f"push speed {number_text(100 * self.push_speed)} cm/s")
        return ", ".join(parts) or str(Family.NOMINAL)


def make_condition(
    size_ratio: float,
    com_shift: float,
    cloud_deviation: float,
    push_speed: float,
    varied_size: bool = False,
) -> Condition:
    """Makes a condition of recorded numbers, in the order of `VARIED`.

    NaN, where something plays no part, is nominal.
    """
    return Condition(
        cloud_deviation=_number(cloud_deviation, _CLOUD_DEVIATION),
        push_speed=_number(push_speed, _PUSH_SPEED),
        com_shift=_number(com_shift, 0.0),
        size_ratio=1.0 if varied_size else _number(size_ratio, 1.0),
        varied_size=varied_size,
    )


def _number(value: float, nominal: float) -> float:
    return nominal if np.isnan(value) else round(float(value), 9)
