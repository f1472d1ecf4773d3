"""Which rows are encoded."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.metrics import MOST_ROWS
from keypush.learning.rows import Rows
from keypush.learning.split import split_rows
from keypush.seeding import make_generator

Index = NDArray[np.int64]


@dataclass(frozen=True)
class Selection:
    """Some of all rows, and the parts of them by their place among these.

    Attributes:
        rows: numbers of the rows, one object after the other, (n,).
        train: places in `rows`.
        validation: the same, of other episodes of the objects that are trained on.
        held_out: the same, of each held-out object.
    """

    rows: Index
    train: Index
    validation: Index
    held_out: dict[str, Index]

    def some_held_out(self) -> Index:
        """Returns at most `MOST_ROWS` places of held-out rows, as many of every object."""
        most = MOST_ROWS // max(len(self.held_out), 1)
        parts = [index[:: -(-len(index) // most) or 1] for index in self.held_out.values()]
        return np.concatenate([*parts, np.empty(0, dtype=np.int64)])


def select_rows(rows: Rows, usable: NDArray[np.bool_], config: ImitationConfig) -> Selection:
    """Draws as many rows of every object as are wanted, and at most `MOST_ROWS` to measure with.

    Args:
        rows: all rows.
        usable: which of them teach something, (n,).
        config: settings.

    Raises:
        UserError: see `split_rows`.
    """
    split = split_rows(rows, usable, config)
    names = np.array([name for name, _ in rows.objects])[rows.object_index]
    rng = make_generator(config.seed, 0, "rows")

    def draw(index: Index, most: int) -> Index:
        return np.sort(rng.permutation(index)[:most]) if most else index

    candidates = split.train.numpy()
    of_object = names[candidates]
    train = [draw(candidates[of_object == n], config.rows_per_object) for n in np.unique(of_object)]
    validation = draw(split.validation.numpy(), MOST_ROWS)
    others = split.held_out.numpy()
    held_out = {n: draw(others[names[others] == n], MOST_ROWS) for n in config.held_out_objects}
    chosen = np.concatenate([*train, validation, *held_out.values()])
    chosen = chosen[np.lexsort((chosen, rows.object_index[chosen]))]
    place = np.empty(len(rows), dtype=np.int64)
    place[chosen] = np.arange(len(chosen))
    return Selection(
        rows=chosen,
        train=place[np.concatenate(train)],
        validation=place[validation],
        held_out={name: place[index] for name, index in held_out.items()},
    )
