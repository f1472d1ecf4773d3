"""What a set of episodes says: success rates, their intervals, and how episodes failed."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import fmean, median
from typing import Any, NotRequired, TypedDict

from keypush.evaluation.wilson import wilson_interval

Episode = Mapping[str, Any]

_MEANS = {
    "mean_object_path": "object_path",
    "mean_tool_path": "tool_path",
    "mean_keypoint_error": "keypoint_error",
}


class ObjectSummary(TypedDict):
    """Statistics of the episodes of one object."""

    episodes: int
    successes: int
    success_rate: float
    wilson95: list[float]
    """Lower and upper end of the 95 % interval of `success_rate`."""
    settled_success_rate: float
    """The rate of passing the test of success again, one second after the tool has stopped."""
    settled_wilson95: list[float]
    failures: dict[str, int]
    """How many episodes ended in each failure class that occurred."""
    reasons: NotRequired[dict[str, int]]
    """How many episodes the policy failed for each reason; left out if none."""
    com_capped: NotRequired[float]
    """Share of episodes whose centre of mass was moved less than asked for; left out if none."""
    median_steps: NotRequired[float | None]
    """Policy steps of the episodes that succeeded; None where none did."""
    mean_object_path: NotRequired[float | None]
    """m; this and the next two over the episodes that have it, None where none has."""
    mean_tool_path: NotRequired[float | None]
    """m."""
    mean_keypoint_error: NotRequired[float | None]
    """m."""


class Summary(ObjectSummary):
    """Statistics of an evaluation, over all its objects and for each."""

    objects: dict[str, ObjectSummary]


def summarise(episodes: Sequence[Episode]) -> Summary:
    """Computes the statistics of finished episodes.

    Args:
        episodes: mappings with at least object (name), success, settled_success (bool) and
            outcome ("success" or a failure class). What else a record has is summarised where it
            is there: reason, com_capped, steps, object_path, tool_path, keypoint_error.

    Raises:
        ValueError: there are no episodes.
    """
    if not episodes:
        raise ValueError("no episodes to summarise")
    by_object: dict[str, list[Episode]] = {}
    for episode in episodes:
        by_object.setdefault(str(episode["object"]), []).append(episode)
    return {
        **summarise_group(episodes),
        "objects": {name: summarise_group(mine) for name, mine in by_object.items()},
    }


def summarise_group(episodes: Sequence[Episode]) -> ObjectSummary:
    """Computes the statistics of at least one episode, whatever their objects."""
    count = len(episodes)
    successes = sum(bool(episode["success"]) for episode in episodes)
    settled = sum(bool(episode["settled_success"]) for episode in episodes)
    failures = Counter(str(e["outcome"]) for e in episodes if not e["success"])
    summary: ObjectSummary = {
        "episodes": count,
        "successes": successes,
        "success_rate": successes / count,
        "wilson95": list(wilson_interval(successes, count)),
        "settled_success_rate": settled / count,
        "settled_wilson95": list(wilson_interval(settled, count)),
        "failures": dict(sorted(failures.items())),
    }
    reasons = Counter(str(e["reason"]) for e in episodes if e.get("reason"))
    if reasons:
        summary["reasons"] = dict(sorted(reasons.items()))
    capped = sum(bool(episode.get("com_capped")) for episode in episodes)
    if capped:
        summary["com_capped"] = capped / count
    if "steps" in episodes[0]:
        steps = [episode["steps"] for episode in episodes if episode["success"]]
        summary["median_steps"] = float(median(steps)) if steps else None
    for name, column in _MEANS.items():
        if column in episodes[0]:
            summary[name] = _mean([episode[column] for episode in episodes])  # type: ignore[literal-required]  # the keys of _MEANS are the summary's
    return summary


def _mean(values: Sequence[float]) -> float | None:
    known = [value for value in values if not math.isnan(value)]
    return fmean(known) if known else None
