"""Policies compared with each other on the same episodes."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from keypush.evaluation.recorded_condition import Family
from keypush.reporting.episodes import Episodes
from keypush.reporting.paired import holm, mcnemar_p, tango_interval
from keypush.reporting.words import MINUS

_UNSEEN = ("id", "ood")
_GROUPS = {"unseen objects": _UNSEEN, "training objects": ("train",), "own objects": ("user",)}


@dataclass(frozen=True)
class Comparison:
    """What the episodes that two policies share say of their difference."""

    family: Family
    objects: str
    """Which objects, in words."""
    drivers: tuple[str, str]
    pairs: int
    """Episodes in which both drove."""
    only_first: int
    """Of these, those in which only the first succeeded."""
    only_second: int
    p_value: float
    """Of McNemar's exact test, adjusted for the number of comparisons by Holm's procedure."""

    @property
    def episodes(self) -> str:
        """Which episodes, in words."""
        return f"{self.objects}, {self.family}"

    @property
    def policies(self) -> str:
        """Which policies, as a difference."""
        return f" {MINUS} ".join(self.drivers)

    @property
    def difference(self) -> float:
        """Success rate of the first less that of the second."""
        return (self.only_first - self.only_second) / self.pairs

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of `difference`."""
        return tango_interval(self.only_first, self.only_second, self.pairs)


def compare_drivers(episodes: Episodes) -> list[Comparison]:
    """Compares every two policies that share episodes, by kind of condition and of objects."""
    found = list(_compare_all(episodes))
    adjusted = holm([comparison.p_value for comparison in found])
    return [replace(c, p_value=p) for c, p in zip(found, adjusted, strict=True)]


def _compare_all(episodes: Episodes) -> Iterator[Comparison]:
    for family in Family:
        of_family = episodes.of(family)
        for objects, sets in _GROUPS.items():
            part = of_family.where(np.isin(of_family["set"], sets))
            for first, second in combinations(part.split("driver"), 2):
                comparison = _compare(family, objects, first, second)
                if comparison is not None:
                    yield comparison


def _compare(
    family: Family, objects: str, first: tuple[str, Episodes], second: tuple[str, Episodes]
) -> Comparison | None:
    (name_1, mine), (name_2, theirs) = first, second
    shared, rows_1, rows_2 = np.intersect1d(mine["start"], theirs["start"], return_indices=True)
    if not len(shared):
        return None
    won_1, won_2 = mine["success"][rows_1], theirs["success"][rows_2]
    only_first, only_second = int((won_1 & ~won_2).sum()), int((won_2 & ~won_1).sum())
    return Comparison(
        family=family,
        objects=objects,
        drivers=(name_1, name_2),
        pairs=len(shared),
        only_first=only_first,
        only_second=only_second,
        p_value=mcnemar_p(only_first, only_second),
    )
