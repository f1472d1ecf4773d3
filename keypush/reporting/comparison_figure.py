"""Figure of the differences between policies."""

import math
from collections.abc import Sequence
from itertools import groupby

from keypush.reporting.comparison import Comparison
from keypush.reporting.figure import Figure, LegendEntry, Panel
from keypush.reporting.svg import WIDTH, Drawing, symbol
from keypush.reporting.words import points, points_range

_LEFT, _RIGHT, _ROW = 14.0, WIDTH - 14.0, 32.0
_STEPS = (0.02, 0.05, 0.1, 0.2, 0.5)
_MOST_TICKS = 7
_SIGNIFICANT = 0.05


def comparison_figure(comparisons: Sequence[Comparison]) -> Figure:
    """Differences with their intervals, a panel for each kind of episodes."""
    ends = [end for comparison in comparisons for end in comparison.interval]
    ticks = _ticks(min(0.0, *ends), max(0.0, *ends))
    panels = [
        Panel(heading, _draw(list(shown), ticks, heading))
        for heading, shown in groupby(comparisons, key=lambda c: c.episodes)
    ]
    legend = [
        LegendEntry(symbol(0, "mark c0"), f"p < {_SIGNIFICANT}"),
        LegendEntry(symbol(0, "hollow"), f"p of {_SIGNIFICANT} or more"),
    ]
    return Figure(
        "Difference of success rates in percentage points, with 95 % intervals.", panels, legend
    )


def _ticks(low: float, high: float) -> list[float]:
    """Round differences that reach from below the lowest to above the highest."""
    for step in _STEPS:
        first, last = math.floor(low / step), math.ceil(high / step)
        if last - first < _MOST_TICKS:
            break
    return [step * number for number in range(first, max(last, first + 1) + 1)]


def _draw(comparisons: Sequence[Comparison], ticks: Sequence[float], heading: str) -> str:
    bottom = _ROW * len(comparisons) + 4
    drawing = Drawing(bottom + 20)

    def across(difference: float) -> float:
        return _LEFT + (difference - ticks[0]) / (ticks[-1] - ticks[0]) * (_RIGHT - _LEFT)

    for tick in ticks:
        drawing.line((across(tick), 4, across(tick), bottom), "grid")
        drawing.text((across(tick), bottom + 15), points(tick).removesuffix(".0"), "middle")
    drawing.line((across(0), 4, across(0), bottom), "zero")
    for number, comparison in enumerate(comparisons):
        y = number * _ROW
        drawing.text((2, y + 13), comparison.policies, "label halo")
        low, high = (across(end) for end in comparison.interval)
        drawing.line((low, y + 24, high, y + 24), "interval c0")
        style = "mark c0" if comparison.p_value < _SIGNIFICANT else "hollow"
        told = f"{points(comparison.difference)} ({points_range(comparison.interval)})"
        drawing.mark(0, (across(comparison.difference), y + 24), style, told)
    return drawing.render(f"Differences between policies, {heading}; the table has the figures.")
