"""Figures of how episodes ended: classes of failure, and where on the table."""

import numpy as np
from numpy.typing import NDArray

from keypush.evaluation.recorded_condition import Family
from keypush.reporting.episodes import Episodes
from keypush.reporting.figure import Figure, LegendEntry, Panel
from keypush.reporting.svg import WIDTH, Drawing, symbol
from keypush.reporting.words import percent
from keypush.scenario import TableConfig

_BAR_LEFT, _BAR_RIGHT, _ROW, _BAR = 4.0, WIDTH - 52.0, 36.0, 12.0
_SCALE = 300.0
"""Pixels per metre of a table seen from above."""
_MAP_TOP = 22.0
_GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
_SPREAD = 2.2
"""Pixels from the middle to the second of several dots at one place."""
_MAP_CENTRES = (82.0, WIDTH - 82.0)


def failure_figure(episodes: Episodes) -> Figure:
    """Shares of the classes of failure, a panel for each kind of condition."""
    parts = {family: episodes.of(family) for family in Family}
    shares = {
        family: {
            driver: {name: float((mine["outcome"] == name).mean()) for name in episodes.failures}
            for driver, mine in part.split("driver")
        }
        for family, part in parts.items()
        if len(part)
    }
    most = max(sum(line.values()) for by in shares.values() for line in by.values())
    end = _round_up(most)
    panels = [
        Panel(str(family), _draw_bars(by_driver, end, family))
        for family, by_driver in shares.items()
    ]
    caption = "Share of episodes that failed, by how they failed."
    return Figure(caption, panels, _failure_legend(episodes))


def _draw_bars(shares: dict[str, dict[str, float]], end: float, family: Family) -> str:
    drawing = Drawing(_ROW * len(shares) + 22)
    bottom = _ROW * len(shares)
    for tick in (0.0, end / 2, end):
        x = _BAR_LEFT + tick / end * (_BAR_RIGHT - _BAR_LEFT)
        drawing.line((x, 4, x, bottom), "grid")
        anchor = "middle" if tick else "start"
        drawing.text((x, bottom + 14), f"{100 * tick:g} %", anchor)
    for number, (driver, line) in enumerate(shares.items()):
        y, x = number * _ROW, _BAR_LEFT
        drawing.text((_BAR_LEFT, y + 13), driver, "label")
        for name, share in line.items():
            width = share / end * (_BAR_RIGHT - _BAR_LEFT)
            told = f"{driver}, {name.replace('_', ' ')}: {percent(share)}"
            if share:
                drawing.rectangle((x, y + 18), (width, _BAR), f"bar {name}", told)
            x += width
        drawing.text((x + 5, y + 28), percent(sum(line.values())), "start")
    return drawing.render(f"Classes of failure of each policy, {family}; see the table.")


def _round_up(share: float) -> float:
    """The next share that is a good end for an axis."""
    ends = (0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8)
    return next((end for end in ends if share <= end), 1.0)


def _failure_legend(episodes: Episodes) -> list[LegendEntry]:
    return [
        LegendEntry(symbol(0, f"mark {name}"), name.replace("_", " ")) for name in episodes.failures
    ]


def map_figure(episodes: Episodes, where: str) -> Figure:
    """Starts and goals on the table from above, a panel for each policy."""
    panels = [
        Panel(f"{driver}, {where}", _draw_maps(mine, driver))
        for driver, mine in episodes.split("driver")
    ]
    legend = [LegendEntry(symbol(0, "mark success"), "success"), *_failure_legend(episodes)]
    caption = (
        "Where objects started and were meant to go, from above, by how the episode ended; dots of "
        "the same place lie around it."
    )
    return Figure(caption, panels, legend)


def _draw_maps(episodes: Episodes, driver: str) -> str:
    table = TableConfig()
    drawing = Drawing(_MAP_TOP + table.length * _SCALE + 22)
    for place, centre in zip(("start", "goal"), _MAP_CENTRES, strict=True):
        _draw_map(drawing, episodes, place, centre)
    told = f"Two maps of the table: starts and goals of {driver}, failures in colour."
    return drawing.render(told)


def _draw_map(drawing: Drawing, episodes: Episodes, place: str, centre: float) -> None:
    """Draws a table with x of W upwards, away from the robot, and y to the left."""
    table = TableConfig()
    width, height = table.width * _SCALE, table.length * _SCALE
    left, middle = centre - width / 2, _MAP_TOP + height / 2
    drawing.text((centre, _MAP_TOP - 8), place, "middle strong")
    drawing.rectangle((left, _MAP_TOP), (width, height), "table")
    drawing.text((centre, _MAP_TOP + height + 15), "robot", "middle")
    across = centre - _SCALE * episodes[f"{place}_y"]
    up = middle - _SCALE * episodes[f"{place}_x"]
    points = fan_out(np.stack([across, up], axis=1))
    kinds = {name: points[episodes["outcome"] == name] for name in ("success", *episodes.failures)}
    # What is rarer is drawn later, so that nothing hides it.
    for name in sorted(kinds, key=lambda name: -len(kinds[name])):
        drawing.dots([(x, y) for x, y in kinds[name]], f"dot {name}")


def fan_out(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lays points (N, 2) that are the same in a sunflower's pattern around their place.

    With one seed all objects get the same starts and goals: their dots would hide each other.
    """
    places = np.unique(np.round(points, 2), axis=0, return_inverse=True)[1].reshape(-1)
    order = np.argsort(places, kind="stable")
    earlier = np.empty(len(points))  # how many before a point have its place
    earlier[order] = np.arange(len(points)) - np.searchsorted(places[order], places[order])
    angle = _GOLDEN_ANGLE * earlier
    offset = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.asarray(points + _SPREAD * np.sqrt(earlier)[:, None] * offset)
