"""What a set of episodes says: success rates, their intervals, and how episodes failed."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NotRequired, TypedDict

from keypush.evaluation.wilson import wilson_interval

Episode = Mapping[str, Any]


class ObjectSummary(TypedDict):
    """Statistics of the episodes of one object."""

    episodes: int
    successes: int
    success_rate: float
    wilson95: list[float]
    """Lower and upper end of the 95 % interval of `success_rate`."""
    failures: dict[str, int]
    """How many episodes ended in each failure class that occurred."""
    com_capped: NotRequired[float]
    """Share of episodes whose centre of mass was moved less than asked for; left out if none."""


class Summary(ObjectSummary):
    """Statistics of an evaluation, over all its objects and for each."""

    settled_success_rate: float
    """The rate of passing the test of success again, one second after the tool has stopped."""
    objects: dict[str, ObjectSummary]


def summarise(episodes: Sequence[Episode]) -> Summary:
    """Computes the statistics of finished episodes.

    Args:
        episodes: mappings with at least object (name), success, settled_success (bool) and
            outcome ("success" or a failure class); com_capped (bool) may be there.

    Raises:
        ValueError: there are no episodes.
    """
    if not episodes:
        raise ValueError("no episodes to summarise")
    settled = sum(bool(episode["settled_success"]) for episode in episodes)
    names = dict.fromkeys(str(episode["object"]) for episode in episodes)
    return {
        **_summarise_object(episodes),
        "settled_success_rate": settled / len(episodes),
        "objects": {
            name: _summarise_object([e for e in episodes if e["object"] == name]) for name in names
        },
    }


def _summarise_object(episodes: Sequence[Episode]) -> ObjectSummary:
    successes = sum(bool(episode["success"]) for episode in episodes)
    failures = Counter(str(e["outcome"]) for e in episodes if not e["success"])
    summary: ObjectSummary = {
        "episodes": len(episodes),
        "successes": successes,
        "success_rate": successes / len(episodes),
        "wilson95": list(wilson_interval(successes, len(episodes))),
        "failures": dict(sorted(failures.items())),
    }
    capped = sum(bool(episode.get("com_capped")) for episode in episodes)
    if capped:
        summary["com_capped"] = capped / len(episodes)
    return summary
