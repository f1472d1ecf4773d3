"""Our success rates beside the thesis', as rows of its tables."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import pyarrow as pa

from keypush.evaluation.summary import Episode, ObjectSummary, summarise_group
from keypush.reproduction.plan import Plan
from keypush.reproduction.thesis_figures import (
    COM_SHIFT,
    SHIFTED,
    SIZE_TABLES,
    shifted_rate,
    size_rate,
)

_SHIFT_WORDS = {False: "normal", True: "shifted"}


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One figure of a table: a policy under a condition."""

    condition: str
    policy: str
    thesis: float | None
    """Its success rate in percent, if it has one."""
    ours: ObjectSummary

    @property
    def difference(self) -> float | None:
        """Ours less the thesis', in percentage points."""
        return None if self.thesis is None else 100 * self.ours["success_rate"] - self.thesis

    def describe(self) -> dict[str, Any]:
        """Returns it for JSON."""
        return {**asdict(self), "difference": self.difference}


class Results:
    """The records of a reproduction, by policy, object and condition."""

    def __init__(self, records: pa.Table, policies: Sequence[str]) -> None:
        """Args: `RECORDS` of all policies, and the policies in the order of the tables."""
        self.policies = policies
        self.episodes = len(records)
        self._groups: dict[tuple[str, str, float, float], list[Episode]] = {}
        for record in records.to_pylist():
            key = record["policy"], record["object"], record["size_ratio"], record["com_shift"]
            self._groups.setdefault(key, []).append(record)

    def summary(
        self, policy: str, objects: Sequence[str], size_ratio: float = 1.0, com_shift: float = 0.0
    ) -> ObjectSummary | None:
        """Returns the statistics of a policy with objects in a condition; None of no episode."""
        episodes = [
            episode
            for name in objects
            for episode in self._groups.get((policy, name, size_ratio, com_shift), ())
        ]
        return summarise_group(episodes) if episodes else None


def size_table(
    results: Results, plan: Plan, group: str, objects: Sequence[str]
) -> list[Comparison]:
    """Returns table 5.5, 5.6 or 5.7: success in every size.

    Args:
        results: of all policies.
        plan: what was run.
        group: train, id or ood.
        objects: the plan's, of this group.
    """
    return [
        Comparison(
            condition=_size_words(size),
            policy=policy,
            thesis=size_rate(group, size, policy),
            ours=ours,
        )
        for size in SIZE_TABLES[group][1]
        if size in plan.sizes
        for policy in results.policies
        if (ours := results.summary(policy, objects, size)) is not None
    ]


def shifted_table(results: Results) -> list[Comparison]:
    """Returns table 5.8: success with the centre of mass where it is, and shifted."""
    return [
        Comparison(
            condition=f"{name}, {_SHIFT_WORDS[shifted]}",
            policy=policy,
            thesis=shifted_rate(name, policy, shifted=shifted),
            ours=ours,
        )
        for name in SHIFTED
        for shifted in (False, True)
        for policy, ours in _by_policy(results, [name], COM_SHIFT if shifted else 0.0)
    ]


def shifted_sets(results: Results, sets: dict[str, list[str]]) -> list[Comparison]:
    """Returns what the thesis lacks: a shifted centre of mass in every set of objects.

    Args:
        results: of all policies.
        sets: objects that were run with it, by train, id and ood; empty ones are left out.
    """
    return [
        Comparison(
            condition=f"{group}, {_SHIFT_WORDS[shifted]}", policy=policy, thesis=None, ours=ours
        )
        for group, names in sets.items()
        for shifted in (False, True)
        for policy, ours in _by_policy(results, names, COM_SHIFT if shifted else 0.0)
    ]


def _by_policy(
    results: Results, names: Sequence[str], com_shift: float
) -> Iterator[tuple[str, ObjectSummary]]:
    for policy in results.policies:
        ours = results.summary(policy, names, com_shift=com_shift)
        if ours is not None:
            yield policy, ours


def _size_words(size_ratio: float) -> str:
    return "original" if size_ratio == 1.0 else f"{100 * (size_ratio - 1):+g} %"
