"""A figure of several small drawings that share a legend."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from keypush.reporting.svg import symbol


class LegendEntry(NamedTuple):
    """What a mark stands for."""

    symbol: str
    """SVG."""
    name: str


class Panel(NamedTuple):
    """One drawing of a figure."""

    heading: str
    svg: str


@dataclass(frozen=True)
class Figure:
    """Drawings beside each other, one below the other on a phone."""

    caption: str
    panels: Sequence[Panel]
    legend: Sequence[LegendEntry]


Drivers = Mapping[str, int]
"""Each driver's number, which chooses its colour and its mark."""


def number_drivers(names: Iterable[str]) -> Drivers:
    """Numbers drivers in their order."""
    return {name: number for number, name in enumerate(names)}


def colour_of(drivers: Drivers, name: str) -> str:
    """The style of a driver's colour, of which there are nine."""
    return f"c{drivers[name] % 9}"


def driver_legend(drivers: Drivers) -> list[LegendEntry]:
    """Returns what stands for each driver."""
    return [
        LegendEntry(symbol(number, f"mark {colour_of(drivers, name)}"), name)
        for name, number in drivers.items()
    ]


def sideways(drivers: Drivers, name: str, gap: float) -> float:
    """How far beside its true place a driver is drawn in pixels, so that none hides another."""
    return gap * (drivers[name] - (len(drivers) - 1) / 2)
