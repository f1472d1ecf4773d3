"""Tables of how episodes went."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from keypush.reporting.episodes import SETS, Episodes
from keypush.reporting.table import ReportTable, Row
from keypush.reporting.words import NOTHING, grouped, percent


def failure_table(episodes: Episodes) -> ReportTable:
    """One row per policy and condition: how many episodes ended in each class of failure."""
    kinds = episodes.failures
    rows = [
        (driver, words, grouped(len(part)), *_shares(part, kinds))
        for driver, mine in episodes.split("driver")
        for words, part in mine.split("condition")
    ]
    return ReportTable(
        "Failures by policy and condition",
        ("policy", "condition"),
        ("N", "failed", *(name.replace("_", " ") for name in kinds)),
        rows,
        "Episodes, and their share of N. Toppled: not upright any more; fell: off the table; "
        "timed out: not at the goal within the policy steps of an episode.",
    )


def reason_table(episodes: Episodes) -> ReportTable:
    """One row per policy and reason for which it gave no answer that could be used."""
    rows = [
        (driver, str(reason), grouped(int((mine["reason"] == reason).sum())))
        for driver, mine in episodes.split("driver")
        for reason in np.unique(mine["reason"][mine["reason"] != ""])
    ]
    return ReportTable(
        "Why policies failed",
        ("policy", "reason"),
        ("episodes",),
        rows,
        "A policy fails when it raises, takes too long or answers with what is no keypoint or "
        "action; the episode ends there and counts as failed.",
    )


def _shares(episodes: Episodes, kinds: Iterable[str]) -> Iterable[str]:
    failed = ~episodes["success"]
    for mask in (failed, *(episodes["outcome"] == name for name in kinds)):
        number = int(mask.sum())
        yield f"{grouped(number)} ({percent(number / len(episodes))})"


def effort_table(episodes: Episodes) -> ReportTable:
    """One row per policy and set: steps and paths of successes, error of the keypoint."""
    rows = [
        (driver, SETS[name], *_efforts(part))
        for driver, mine in episodes.split("driver")
        for name, part in mine.split("set")
    ]
    return ReportTable(
        "Steps, paths and keypoints",
        ("policy", "objects"),
        (
            "successes",
            "steps",
            "object's path",
            "tool's path",
            "keypoint error",
            "90 % of errors below",
        ),
        rows,
        "Medians: of successful episodes for steps and paths. The keypoint's error is the mean "
        "distance in an episode between the contact at which the policy aims and the measured one, "
        "where there is one: how well the tool reaches where it aims, not whether that is a good "
        "place.",
    )


def _efforts(episodes: Episodes) -> Row:
    won = episodes.where(episodes["success"])
    errors = episodes["keypoint_error"]
    errors = errors[np.isfinite(errors)]
    return (
        grouped(len(won)),
        _quantile(won["steps"], 0.5, 1.0, "{:.0f}"),
        _quantile(won["object_path"], 0.5, 100.0, "{:.1f} cm"),
        _quantile(won["tool_path"], 0.5, 100.0, "{:.1f} cm"),
        _quantile(errors, 0.5, 1000.0, "{:.1f} mm"),
        _quantile(errors, 0.9, 1000.0, "{:.1f} mm"),
    )


def _quantile(values: NDArray[np.generic], share: float, factor: float, form: str) -> str:
    if not len(values):
        return NOTHING
    return form.format(factor * float(np.quantile(np.asarray(values, dtype=float), share)))
