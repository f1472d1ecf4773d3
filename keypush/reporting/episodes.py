"""Recorded episodes as columns that can be split."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from keypush.errors import UserError
from keypush.evaluation.recorded_condition import VARIED, Condition, Family, make_condition
from keypush.evaluation.records import RECORDS
from keypush.reporting.drivers import name_drivers
from keypush.reporting.runs import RUN
from keypush.systems.episode_monitor import Outcome

SETS = {
    "train": "training objects",
    "id": "unseen (similar)",
    "ood": "unseen (different)",
    "user": "own objects",
}
"""Sets of objects, and how a report calls them."""
FAILURES = tuple(
    outcome.name.lower() for outcome in Outcome if outcome not in (Outcome.RUNNING, Outcome.SUCCESS)
)
"""Classes of failure."""
_SELDOM = Outcome.POLICY_FAILED.name.lower()
_START = ("object", "condition", "size_ratio", "seed", "episode")


@dataclass(frozen=True)
class Episodes:
    """Episodes, one entry per episode in every column.

    Beside the columns of `RECORDS`: driver (see `name_drivers`), condition
    (`Condition.words`), family (`Family`), start (a number that is the same for episodes of the
    same object, condition, size, seed and number).
    """

    columns: Mapping[str, NDArray[Any]]
    order: Mapping[str, Sequence[str]]
    """In which order the values of driver, set, object and condition are shown."""

    def __len__(self) -> int:
        return len(self.columns["start"])

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    @property
    def failures(self) -> tuple[str, ...]:
        """Classes of failure that are worth a column."""
        return told_failures(set(self["outcome"]))

    def where(self, mask: NDArray[np.bool_]) -> "Episodes":
        """Returns the episodes of a mask (N,)."""
        return Episodes({name: column[mask] for name, column in self.columns.items()}, self.order)

    def of(self, *families: Family) -> "Episodes":
        """Returns the episodes whose condition is of one of these kinds."""
        return self.where(np.isin(self["family"], [str(family) for family in families]))

    def split(self, name: str) -> Iterator[tuple[str, "Episodes"]]:
        """Yields each value of a column in `order` that occurs, with its episodes."""
        for value in self.order[name]:
            part = self.where(self[name] == value)
            if len(part):
                yield value, part

    def values(self, name: str) -> list[str]:
        """Returns the values of a column in `order` that occur."""
        occurring = set(self[name])
        return [value for value in self.order[name] if value in occurring]


def told_failures(occurring: Collection[str]) -> tuple[str, ...]:
    """Returns the classes of failure that are worth a column: a policy's own only if it occurs.

    Args:
        occurring: outcomes that there are.
    """
    return tuple(name for name in FAILURES if name != _SELDOM or name in occurring)


def gather_episodes(table: pa.Table) -> Episodes:
    """Makes episodes of the rows that `read_runs` found.

    An episode may lie in several folders, as in that of an evaluation and in one that holds
    several evaluations: where all of its record agrees it counts once.

    Raises:
        UserError: an episode is there twice and differs, or a set or an outcome has an
            unknown name.
    """
    columns = {name: _to_numpy(table[name]) for name in table.column_names}
    _check_names(columns, "set", SETS)
    _check_names(columns, "outcome", ("success", *FAILURES))
    varied = [columns[name] for name in VARIED]
    conditions = [
        make_condition(*values) for values in zip(*varied, _has_own_size(columns), strict=True)
    ]
    columns["driver"] = name_drivers(columns)
    columns["condition"] = np.array([condition.words for condition in conditions])
    columns["family"] = np.array([str(condition.family) for condition in conditions])
    columns["start"] = _number_rows(columns, _START)
    return Episodes(_without_copies(columns), _order(columns, conditions))


def _to_numpy(column: pa.ChunkedArray) -> NDArray[Any]:
    values: NDArray[Any] = column.to_numpy()
    return values.astype(str) if values.dtype == object else values


def _check_names(
    columns: Mapping[str, NDArray[Any]], name: str, allowed: Sequence[str] | Mapping[str, str]
) -> None:
    unknown = ~np.isin(columns[name], list(allowed))
    if unknown.any():
        first = int(np.argmax(unknown))
        raise UserError(
            f"{columns[RUN][first]}: {name} is {str(columns[name][first])!r}; "
            f"allowed: {', '.join(allowed)}"
        )


def _has_own_size(columns: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """Whether the sizes differ among the episodes (N,) of one folder, which has one condition."""
    folders, sizes = _number_rows(columns, (RUN, "folder")), columns["size_ratio"]
    smallest, largest = np.full(len(sizes), np.inf), np.zeros(len(sizes))
    np.minimum.at(smallest, folders, sizes)
    np.maximum.at(largest, folders, sizes)
    return np.asarray(smallest[folders] < largest[folders])


def _number_rows(columns: Mapping[str, NDArray[Any]], names: Sequence[str]) -> NDArray[np.int64]:
    """Gives rows (N,) the same number where these columns agree."""
    codes = [np.unique(columns[name], return_inverse=True)[1] for name in names]
    numbers = np.unique(np.stack(codes, axis=1), axis=0, return_inverse=True)[1]
    return np.asarray(numbers, dtype=np.int64).reshape(-1)


def _without_copies(columns: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Leaves out episodes that are there already, with the same record."""
    numbers = _number_rows(columns, ("driver", "start"))
    _, first = np.unique(numbers, return_index=True)
    original = first[numbers]
    for name in RECORDS.names:
        if name == "folder":
            continue
        mine, theirs = columns[name], columns[name][original]
        same = mine == theirs
        if mine.dtype.kind == "f":
            same |= np.isnan(mine) & np.isnan(theirs)
        if not same.all():
            raise _contradiction(columns, name, int(np.argmin(same)), original)
    kept = np.sort(first)
    return {name: column[kept] for name, column in columns.items()}


def _contradiction(
    columns: Mapping[str, NDArray[Any]], name: str, row: int, original: NDArray[np.int64]
) -> UserError:
    other = int(original[row])
    what = ", ".join(str(columns[key][row]) for key in ("driver", "object", "condition"))
    return UserError(
        f"{columns[RUN][row]}: {name} of episode {columns['episode'][row]}, seed "
        f"{columns['seed'][row]} ({what}) is {columns[name][row]!s} here and "
        f"{columns[name][other]!s} in {columns[RUN][other]}; allowed: the same record, counted once"
    )


def _order(
    columns: Mapping[str, NDArray[Any]], conditions: Sequence[Condition]
) -> dict[str, list[str]]:
    families = list(Family)
    ranked = sorted(set(conditions), key=lambda c: (families.index(c.family), c))
    return {
        "driver": [str(name) for name in dict.fromkeys(columns["driver"])],
        "set": list(SETS),
        "object": [str(name) for name in dict.fromkeys(columns["object"])],
        "condition": [condition.words for condition in ranked],
    }
