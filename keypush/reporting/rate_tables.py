"""Tables of success rates."""

from collections.abc import Iterator, Sequence

import numpy as np

from keypush.evaluation.conditions import number_text
from keypush.reporting.comparison import Comparison
from keypush.reporting.episodes import SETS, Episodes
from keypush.reporting.table import ReportTable, Row
from keypush.reporting.tally import tally
from keypush.reporting.words import (
    NOTHING,
    grouped,
    p_value,
    percent,
    percent_range,
    points,
    points_range,
)

_RATES = ("N", "success", "95 % interval", "settled")
_BOTH_UNSEEN = "unseen (both)"


def set_table(episodes: Episodes) -> ReportTable:
    """One row per policy and set of objects, and one for both unseen sets together."""
    rows = [
        (driver, objects, *_rates(part))
        for driver, mine in episodes.split("driver")
        for objects, part in _sets(mine)
    ]
    return ReportTable(
        "Success by policy and objects",
        ("policy", "objects"),
        _RATES,
        rows,
        "Settled: the goal still held one second after the tool had stopped.",
    )


def _sets(episodes: Episodes) -> Iterator[tuple[str, Episodes]]:
    for name, part in episodes.split("set"):
        yield SETS[name], part
    if {"id", "ood"} <= set(episodes["set"]):
        yield _BOTH_UNSEEN, episodes.where(np.isin(episodes["set"], ("id", "ood")))


def size_table(episodes: Episodes) -> ReportTable:
    """One row per policy, set and size."""
    rows = [
        (driver, SETS[name], number_text(size), *_rates(part.where(part["size_ratio"] == size)))
        for driver, mine in episodes.split("driver")
        for name, part in mine.split("set")
        for size in np.unique(part["size_ratio"])
    ]
    return ReportTable(
        "Success by size",
        ("policy", "objects", "size"),
        _RATES,
        rows,
        "Size: relative to the object's own.",
    )


def shift_table(episodes: Episodes) -> ReportTable:
    """One row per policy, shift of the centre of mass and set."""
    rows = [
        (driver, words, SETS[name], *_rates(part), percent(float(part["com_capped"].mean())))
        for driver, mine in episodes.split("driver")
        for words, shifted in mine.split("condition")
        for name, part in shifted.split("set")
    ]
    return ReportTable(
        "Success with a shifted centre of mass",
        ("policy", "condition", "objects"),
        (*_RATES, "capped"),
        rows,
        "Capped: share of episodes with a smaller shift than wanted, so that the object can stand.",
    )


def condition_table(episodes: Episodes) -> ReportTable:
    """One row per policy, condition and set."""
    rows = [
        (driver, words, SETS[name], *_rates(part))
        for driver, mine in episodes.split("driver")
        for words, varied in mine.split("condition")
        for name, part in varied.split("set")
    ]
    return ReportTable(
        "Success in other conditions", ("policy", "condition", "objects"), _RATES, rows
    )


def object_table(episodes: Episodes, condition: str = "") -> ReportTable:
    """One row per object, one column per policy.

    Args:
        episodes: to tell of.
        condition: theirs, for the caption, where the text above the table does not tell it.
    """
    drivers = episodes.values("driver")
    rows: list[Row] = []
    for name, of_set in episodes.split("set"):
        for thing, part in of_set.split("object"):
            found = dict(part.split("driver"))
            cells = [_fraction(found[name]) if name in found else NOTHING for name in drivers]
            rows.append((SETS[name], thing, *cells))
    return ReportTable(
        f"Success by object{condition and f', {condition}'}",
        ("objects", "object"),
        drivers,
        rows,
        "Successes of episodes, with the 95 % interval of the rate.",
    )


def _fraction(episodes: Episodes) -> str:
    counted = tally(episodes)
    return f"{counted.successes}/{counted.episodes} ({percent_range(counted.interval)})"


def _rates(episodes: Episodes) -> Row:
    counted = tally(episodes)
    return (
        grouped(counted.episodes),
        percent(counted.rate),
        percent_range(counted.interval),
        percent(counted.settled / counted.episodes),
    )


def comparison_table(comparisons: Sequence[Comparison]) -> ReportTable:
    """One row per comparison of two policies."""
    rows = [
        (
            c.episodes,
            c.policies,
            grouped(c.pairs),
            str(c.only_first),
            str(c.only_second),
            points(c.difference),
            points_range(c.interval),
            p_value(c.p_value),
        )
        for c in comparisons
    ]
    return ReportTable(
        "Differences between policies on the same episodes",
        ("episodes", "policies"),
        ("pairs", "only first", "only second", "difference", "95 % interval", "p"),
        rows,
        "Difference: success rate of the first policy less that of the second, in percentage "
        "points; its interval is that of one row alone. p: McNemar's exact test, adjusted for all "
        "rows by Holm's procedure.",
    )
