"""A report: words, tables and figures, in the order in which they are read."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from keypush.evaluation.recorded_condition import Family
from keypush.policies import POLICIES, find_policy, is_own_policy
from keypush.reporting.comparison import compare_drivers
from keypush.reporting.comparison_figure import comparison_figure
from keypush.reporting.detail_tables import effort_table, failure_table, reason_table
from keypush.reporting.episodes import SETS, Episodes
from keypush.reporting.figure import Drivers, Figure, number_drivers
from keypush.reporting.outcome_figures import failure_figure, map_figure
from keypush.reporting.rate_figures import keypoint_figure, object_figure, set_figure, size_figure
from keypush.reporting.rate_tables import (
    comparison_table,
    condition_table,
    object_table,
    set_table,
    shift_table,
    size_table,
)
from keypush.reporting.table import ReportTable
from keypush.reporting.words import count, listed

_METHOD = (
    "An episode succeeds when the object comes within the goal's radius, upright and on the table. "
    "Intervals of rates are Wilson's score intervals at 95 %. Differences between policies use the "
    "episodes that both drove: McNemar's exact test, and Tango's score interval for paired rates. "
    "All of them take episodes as independent draws: they speak of these objects with other starts "
    "and goals, not of other objects. Where all objects and conditions were given the same starts "
    "and goals, as by one seed, rates over several of them are a little less certain than told."
)


@dataclass(frozen=True)
class Section:
    """A part of a report with a heading."""

    title: str
    text: str = ""
    tables: Sequence[ReportTable] = ()
    figures: Sequence[Figure] = field(default=(), repr=False)


@dataclass(frozen=True)
class Report:
    """All that is told of some evaluations."""

    title: str
    lead: str
    """What was run, in a sentence or two."""
    facts: Sequence[tuple[str, str]]
    """What was run, point by point."""
    sections: Sequence[Section]


def build_report(episodes: Episodes, unlike: str = "") -> Report:
    """Makes the report of some episodes, at least one.

    Args:
        episodes: what to tell of.
        unlike: how their runs differ in what is not compared, see `find_differences`.
    """
    drivers = number_drivers(episodes.values("driver"))
    makers: Sequence[Callable[[Episodes, Drivers], Section | None]] = (
        _success, _sizes, _shifts, _others, _compared, _objects, _failures, _keypoints, _places,
    )  # fmt: skip
    sections = [section for make in makers if (section := make(episodes, drivers)) is not None]
    return Report(
        "Evaluation of pushing policies",
        _lead(episodes),
        [*_facts(episodes), *([("caution", unlike)] if unlike else [])],
        [*sections, Section("How to read this", _METHOD)],
    )


def _lead(episodes: Episodes) -> str:
    drivers, things = episodes.values("driver"), episodes.values("object")
    return (
        f"{count(len(drivers), 'policy', 'policies')} pushed "
        f"{count(len(things), 'object', 'objects')} to a goal on a table, in "
        f"{_episodes(len(episodes))}."
    )


def _facts(episodes: Episodes) -> Iterator[tuple[str, str]]:
    for driver, mine in episodes.split("driver"):
        weights = str(mine["weights"][0])
        parts = [_description(str(mine["policy"][0])), weights and f"weights {weights}"]
        yield driver, "; ".join(part for part in (*parts, _episodes(len(mine))) if part)
    things = [f"{SETS[name]}: {len(part.values('object'))}" for name, part in episodes.split("set")]
    yield "objects", ", ".join(things)
    yield "episodes", _episodes_per_cell(episodes)
    yield "conditions", "; ".join(episodes.values("condition"))
    seeds = [str(seed) for seed in np.unique(episodes["seed"])]
    yield "seed" if len(seeds) == 1 else "seeds", listed(seeds)


def _description(policy: str) -> str:
    """Who drove, in words; nothing of a policy that another version of keypush knows."""
    known = policy in POLICIES or is_own_policy(policy)
    return find_policy(policy).description if known else ""


def _episodes_per_cell(episodes: Episodes) -> str:
    sizes = {
        len(part)
        for _, driven in episodes.split("driver")
        for _, varied in driven.split("condition")
        for _, part in varied.split("object")
    }
    low, high = min(sizes), max(sizes)
    number = "" if low == high else f"{low} to "
    return f"{number}{_episodes(high)} per policy, condition and object"


def _episodes(number: int) -> str:
    return count(number, "episode", "episodes")


def _baseline(episodes: Episodes) -> tuple[Episodes, str, str]:
    """Nominal episodes, or all where none is nominal; what to call them, in short and at length."""
    nominal = episodes.of(Family.NOMINAL)
    if len(nominal):
        return nominal, "nominal", "With nominal size, centre of mass, cloud noise and push speed."
    return episodes, "all conditions", "Over all conditions, as no episode was nominal."


def _success(episodes: Episodes, drivers: Drivers) -> Section | None:
    part, where, text = _baseline(episodes)
    return Section("Success", text, [set_table(part)], [set_figure({where: part}, drivers)])


def _sizes(episodes: Episodes, drivers: Drivers) -> Section | None:
    part = episodes.of(Family.NOMINAL, Family.SIZE)
    if not len(episodes.of(Family.SIZE)):
        return None
    return Section("Size", "", [size_table(part)], [size_figure(part, drivers)])


def _shifts(episodes: Episodes, drivers: Drivers) -> Section | None:
    part = episodes.of(Family.SHIFT)
    if not len(part):
        return None
    panels = dict(episodes.of(Family.NOMINAL, Family.SHIFT).split("condition"))
    by_object = [object_table(shifted, words) for words, shifted in part.split("condition")]
    figure = set_figure(panels, drivers)
    return Section("Centre of mass", "", [shift_table(part), *by_object], [figure])


def _others(episodes: Episodes, _drivers: Drivers) -> Section | None:
    part = episodes.of(Family.OTHER)
    return Section("Other conditions", "", [condition_table(part)]) if len(part) else None


def _objects(episodes: Episodes, drivers: Drivers) -> Section | None:
    part, _, text = _baseline(episodes)
    return Section("Objects", text, [object_table(part)], [object_figure(part, drivers)])


def _failures(episodes: Episodes, _drivers: Drivers) -> Section | None:
    failed = not episodes["success"].all()
    figures = [failure_figure(episodes)] if failed else []
    reasons = reason_table(episodes)
    tables = [failure_table(episodes), *([reasons] if reasons.rows else [])]
    return Section("Failures", "", tables, figures)


def _keypoints(episodes: Episodes, drivers: Drivers) -> Section | None:
    part, where, text = _baseline(episodes)
    measured = bool(np.isfinite(part["keypoint_error"]).any())
    figures = [keypoint_figure(part, drivers, where)] if measured else []
    return Section("Effort and keypoints", text, [effort_table(part)], figures)


def _compared(episodes: Episodes, _drivers: Drivers) -> Section | None:
    comparisons = compare_drivers(episodes)
    if not comparisons:
        return None
    return Section(
        "Policies against each other",
        "",
        [comparison_table(comparisons)],
        [comparison_figure(comparisons)],
    )


def _places(episodes: Episodes, _drivers: Drivers) -> Section | None:
    part, where, _ = _baseline(episodes)
    return Section("Places", "", [], [map_figure(part, where)])
