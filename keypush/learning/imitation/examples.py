"""Rows as inputs and targets of the thesis' networks, without their clouds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from keypush.dataset.poses import hand_states, rotations
from keypush.learning.rows import Rows
from keypush.networks.normalisation import normalise_hand, normalise_positions


@dataclass(frozen=True)
class Examples:
    """n examples, normalised (`networks.normalisation`), in float32; frame W.

    Attributes:
        objects: (name, size ratio) pairs.
        object_index: entry of `objects`, (n,), ascending.
        R_WO: (n, 3, 3).
        p_WO: (n, 3).
        hand: (n, 9).
        query: goal xy and, if wanted, the COM, (n, 2 or 5).
        target: (n, 3 or 6).
        direction: unit vector from the COM to the goal, (n, 2).
    """

    objects: Sequence[tuple[str, float]]
    object_index: torch.Tensor
    R_WO: torch.Tensor
    p_WO: torch.Tensor
    hand: torch.Tensor
    query: torch.Tensor
    target: torch.Tensor
    direction: torch.Tensor

    def __len__(self) -> int:
        return len(self.object_index)

    def without_com(self) -> "Examples":
        """The same examples, of which the network is told the goal alone."""
        return replace(self, query=self.query[:, :2].contiguous())


def make_examples(
    rows: Rows, targets: NDArray[np.float64], chosen: NDArray[np.int64], *, use_com: bool
) -> Examples:
    """Makes examples of some rows; `targets` (n, ...) are those of all."""
    com, goal, pose = rows.com[chosen], rows.goal[chosen], rows.object_pose[chosen]
    query = normalise_positions(goal)
    if use_com:
        query = np.hstack([query, normalise_positions(com)])
    offset = goal - com[:, :2]
    direction = offset / np.maximum(np.linalg.norm(offset, axis=1, keepdims=True), 1e-12)

    def tensor(values: NDArray[np.floating]) -> torch.Tensor:
        return torch.from_numpy(values.astype(np.float32))

    return Examples(
        objects=rows.objects,
        object_index=torch.from_numpy(rows.object_index[chosen]),
        R_WO=tensor(rotations(pose)),
        p_WO=tensor(normalise_positions(pose[:, 4:])),
        hand=tensor(normalise_hand(hand_states(rows.tool_pose[chosen]))),
        query=tensor(query),
        target=tensor(targets[chosen]),
        direction=tensor(direction),
    )
