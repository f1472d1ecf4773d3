"""Figures of success rates: by objects, by size, by the keypoint's error."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from keypush.evaluation.conditions import number_text
from keypush.reporting.episodes import SETS, Episodes
from keypush.reporting.figure import (
    Drivers,
    Figure,
    Panel,
    colour_of,
    driver_legend,
    sideways,
)
from keypush.reporting.rate_axis import RateAxis
from keypush.reporting.svg import WIDTH, Drawing
from keypush.reporting.tally import Tally, tally
from keypush.reporting.words import percent, success_words

_HEIGHT, _TOP, _BOTTOM, _LEFT, _RIGHT = 220.0, 10.0, 182.0, 44.0, WIDTH - 12.0
_ROW_LEFT = 114.0
_ERROR_EDGES = np.array([0.0, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, np.inf])
_NONE = -1
"""The bin of episodes without an error; it stands before the others."""


def size_figure(episodes: Episodes, drivers: Drivers) -> Figure:
    """Success by size, a panel for each set of objects."""
    curves = {
        name: {driver: _by_size(mine) for driver, mine in part.split("driver")}
        for name, part in episodes.split("set")
    }
    sizes = np.unique(episodes["size_ratio"])
    spread = (sizes[0], sizes[-1])
    axis = RateAxis(_all(curves.values()), _BOTTOM, _TOP)
    panels = []
    for name, by_driver in curves.items():
        drawing = Drawing(_HEIGHT)
        _rate_grid(drawing, axis)
        for size in sizes:
            drawing.text((_across(size, spread), _BOTTOM + 16), number_text(size), "middle")
        drawing.text(((_LEFT + _RIGHT) / 2, _HEIGHT - 6), "size of the object", "middle strong")
        _draw_curves(drawing, by_driver, drivers, axis, lambda size: _across(size, spread))
        told = f"Success of each policy by size of the object, {SETS[name]}; see the table."
        panels.append(Panel(SETS[name], drawing.render(told)))
    caption = "Success by size of the object, with 95 % intervals."
    return Figure(caption, panels, driver_legend(drivers))


def _by_size(episodes: Episodes) -> dict[float, Tally]:
    return {
        float(size): tally(episodes.where(episodes["size_ratio"] == size))
        for size in np.unique(episodes["size_ratio"])
    }


def keypoint_figure(episodes: Episodes, drivers: Drivers, where: str) -> Figure:
    """Success of episodes whose keypoint was off by so much, in one panel.

    Args:
        episodes: at least one has a keypoint error.
        drivers: of the report.
        where: which episodes they are.
    """
    measured = np.isfinite(episodes["keypoint_error"])
    aiming = np.unique(episodes["driver"][measured])
    episodes = episodes.where(np.isin(episodes["driver"], aiming))
    edges = error_edges(episodes["keypoint_error"])
    curves = {driver: _by_error(mine, edges) for driver, mine in episodes.split("driver")}
    with_none = any(_NONE in tallies for tallies in curves.values())
    places = (_NONE - 0.5 if with_none else -0.5, len(edges) - 1.5)
    axis = RateAxis(_all([curves]), _BOTTOM, _TOP)
    drawing = Drawing(_HEIGHT)
    _rate_grid(drawing, axis)
    for number, edge in enumerate(edges[np.isfinite(edges)]):
        x = _across(number - 0.5, places)
        drawing.line((x, _BOTTOM, x, _BOTTOM + 4), "grid")
        drawing.text((x, _BOTTOM + 16), f"{1000 * edge:g}", "middle")
    if with_none:
        drawing.text((_across(_NONE, places) - 13, _BOTTOM + 16), "none", "middle")
    drawing.text(((_LEFT + _RIGHT) / 2, _HEIGHT - 6), "keypoint error, mm", "middle strong")
    _draw_curves(drawing, curves, drivers, axis, lambda number: _across(number, places))
    told = "Success of each policy in episodes grouped by the error of its keypoint."
    return Figure(
        "Success by how far the measured contact was from where the policy aimed; none: no contact "
        "was measured while it pushed.",
        [Panel(where, drawing.render(told))],
        driver_legend({name: number for name, number in drivers.items() if name in curves}),
    )


def error_edges(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the edges in m of bins that hold errors (N,), NaN aside; at least one is a number."""
    finite = errors[np.isfinite(errors)]
    bins = np.searchsorted(_ERROR_EDGES, finite, side="right") - 1
    return _ERROR_EDGES[bins.min() : bins.max() + 2]


def _by_error(episodes: Episodes, edges: NDArray[np.float64]) -> dict[float, Tally]:
    errors = episodes["keypoint_error"]
    bins = np.searchsorted(edges, errors, side="right") - 1
    bins[np.isnan(errors)] = _NONE
    return {float(number): tally(episodes.where(bins == number)) for number in np.unique(bins)}


def set_figure(panels: Mapping[str, Episodes], drivers: Drivers) -> Figure:
    """Success by set of objects, a panel for each of several groups of episodes."""
    rows = {
        heading: {SETS[name]: _by_driver(part) for name, part in episodes.split("set")}
        for heading, episodes in panels.items()
    }
    return _rows_figure("Success by policy and objects, with 95 % intervals.", rows, drivers)


def object_figure(episodes: Episodes, drivers: Drivers) -> Figure:
    """Success by object, a panel for each set of objects."""
    rows = {
        SETS[name]: {thing: _by_driver(mine) for thing, mine in part.split("object")}
        for name, part in episodes.split("set")
    }
    return _rows_figure("Success by object, with 95 % intervals.", rows, drivers)


def _by_driver(episodes: Episodes) -> dict[str, Tally]:
    return {driver: tally(mine) for driver, mine in episodes.split("driver")}


def _rows_figure(
    caption: str, panels: Mapping[str, Mapping[str, Mapping[str, Tally]]], drivers: Drivers
) -> Figure:
    axis = RateAxis(_all(panels.values()), _ROW_LEFT, WIDTH - 24.0)
    drawn = [
        Panel(heading, _draw_rows(rows, drivers, axis, f"{caption} Here: {heading}."))
        for heading, rows in panels.items()
    ]
    return Figure(caption, drawn, driver_legend(drivers))


def _draw_rows(
    rows: Mapping[str, Mapping[str, Tally]], drivers: Drivers, axis: RateAxis, told: str
) -> str:
    height = max(18.0, 7.0 * len(drivers) + 7.0)
    bottom = _TOP + height * len(rows)
    drawing = Drawing(bottom + 22)
    for number in range(0, len(rows), 2):
        drawing.rectangle((0, _TOP + number * height), (WIDTH, height), "band")
    for rate in axis.ticks():
        drawing.line((axis.at(rate), _TOP, axis.at(rate), bottom), "grid")
        drawing.text((axis.at(rate), bottom + 15), f"{100 * rate:.0f} %", "middle")
    for number, (name, tallies) in enumerate(rows.items()):
        middle = _TOP + (number + 0.5) * height
        drawing.text((4, middle + 4), name, "label")
        for driver, counted in tallies.items():
            y = middle + sideways(drivers, driver, 7.0)
            low, high = (axis.at(end) for end in counted.interval)
            colour = colour_of(drivers, driver)
            drawing.line((low, y, high, y), f"interval {colour}")
            words = f"{name}, {driver}: {success_words(counted)}"
            drawing.mark(drivers[driver], (axis.at(counted.rate), y), f"mark {colour}", words)
    return drawing.render(f"{told} The table has the figures.")


def _draw_curves(
    drawing: Drawing,
    curves: Mapping[str, Mapping[float, Tally]],
    drivers: Drivers,
    axis: RateAxis,
    across: Callable[[float], float],
) -> None:
    for driver, tallies in curves.items():
        colour, beside = (
            colour_of(drivers, driver),
            sideways(drivers, driver, min(5.0, 30 / len(drivers))),
        )
        places = [(across(value) + beside, axis.at(t.rate)) for value, t in tallies.items()]
        # What has no place on the scale stands apart.
        joined = [place for place, value in zip(places, tallies, strict=True) if value != _NONE]
        drawing.path(joined, f"curve {colour}")
        for (x, y), counted in zip(places, tallies.values(), strict=True):
            low, high = (axis.at(end) for end in counted.interval)
            drawing.line((x, low, x, high), f"interval {colour}")
            told = f"{driver}: {success_words(counted)}"
            drawing.mark(drivers[driver], (x, y), f"mark {colour}", told)


def _rate_grid(drawing: Drawing, axis: RateAxis) -> None:
    for rate in axis.ticks():
        y = axis.at(rate)
        drawing.line((_LEFT, y, _RIGHT, y), "grid")
        drawing.text((_LEFT - 6, y + 4), percent(rate).replace(".0", ""), "end")


def _across(value: float, spread: tuple[float, float]) -> float:
    """The pixel of a value between the first and the last, which keep off the edges."""
    low, high = spread
    margin = 26.0
    share = 0.5 if low == high else (value - low) / (high - low)
    return _LEFT + margin + share * (_RIGHT - _LEFT - 2 * margin)


def _all(groups: Iterable[Mapping[str, Mapping[Any, Tally]]]) -> list[Tally]:
    return [t for curves in groups for tallies in curves.values() for t in tallies.values()]
