"""Which rows are trained on."""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from keypush.errors import UserError
from keypush.learning.config import DataConfig
from keypush.learning.rows import Rows
from keypush.seeding import make_generator


@dataclass(frozen=True)
class Split:
    """Indices of rows that teach something."""

    train: torch.Tensor
    validation: torch.Tensor
    """Other episodes of the objects that are trained on."""
    held_out: torch.Tensor
    """All episodes of the other objects."""


def split_rows(rows: Rows, usable: NDArray[np.bool_], config: DataConfig) -> Split:
    """Splits by whole episodes, so that no neighbour of a validation row is trained on.

    Args:
        rows: all rows.
        usable: which of them teach something, (n,).
        config: settings.

    Raises:
        UserError: a held-out object is not in the data or has no label there, or too few
            episodes have labels.
    """
    names = np.array([name for name, _ in rows.objects])
    unknown = sorted(set(config.held_out_objects) - set(names.tolist()))
    if unknown:
        raise UserError(
            f"held_out_objects has {', '.join(unknown)}; allowed: {', '.join(sorted(set(names)))}"
        )
    held_out = np.isin(names, config.held_out_objects)[rows.object_index] & usable
    silent = set(config.held_out_objects) - set(names[rows.object_index[held_out]])
    if silent:
        raise UserError(
            f"held_out_objects has {', '.join(sorted(silent))}, of which no frame has a label; "
            "allowed: objects that the expert touched"
        )
    usable = usable & ~held_out
    episodes = np.unique(rows.episode[usable])
    if len(episodes) < 2:
        raise UserError(
            f"data: {len(episodes)} episodes have labelled rows to train on, held_out_objects left "
            "out; allowed: at least 2"
        )
    make_generator(config.seed, 0, "validation_split").shuffle(episodes)
    count = min(max(1, round(config.validation_share * len(episodes))), len(episodes) - 1)
    validation = np.isin(rows.episode, episodes[:count]) & usable
    return Split(*(
        torch.from_numpy(np.flatnonzero(mask))
        for mask in (usable & ~validation, validation, held_out)
    ))  # fmt: skip
