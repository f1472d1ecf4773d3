"""Objects to draw contact scenes of: where their surfaces are and how they rest."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from keypush.learning.clouds import Sampler, surface_samplers
from keypush.objects.library import load_object
from keypush.objects.resting import MOST_POSES

UPRIGHT_SHARE = 0.7
"""Share of resting objects that stand upright, as in the task; the others lie as if tossed."""


@dataclass(frozen=True)
class ContactObjects:
    """K objects at size ratio 1, each with up to P resting poses.

    Attributes:
        names: (K,).
        samplers: draw points on their surfaces, (K,).
        R_rest: (K, P, 3, 3).
        height: of Oo above the table, (K, P), m.
        share: how often a pose is drawn, (K, P).
    """

    names: Sequence[str]
    samplers: Sequence[Sampler]
    R_rest: torch.Tensor
    height: torch.Tensor
    share: torch.Tensor

    def rest(self, index: torch.Tensor, rng: torch.Generator) -> tuple[torch.Tensor, torch.Tensor]:
        """Draws resting poses of objects (B,): rotations (B, 3, 3) and heights (B,), m."""
        pose = torch.multinomial(self.share[index], 1, generator=rng)[:, 0]
        return self.R_rest[index, pose], self.height[index, pose]


def contact_objects(names: Sequence[str]) -> ContactObjects:
    """Reads objects.

    Raises:
        UserError: there is no such object, or its files are damaged.
    """
    rotations = np.zeros((len(names), MOST_POSES, 3, 3), dtype=np.float32)
    height, share = np.zeros((2, len(names), MOST_POSES), dtype=np.float32)
    for k, name in enumerate(names):
        poses = load_object(name).poses
        for i, pose in enumerate(poses):
            rotations[k, i], height[k, i] = pose.R_WO.matrix(), pose.height
        tossed = np.array([pose.share for pose in poses])
        share[k, : len(poses)] = (1 - UPRIGHT_SHARE) * tossed / tossed.sum()
        share[k, 0] += UPRIGHT_SHARE
    tables = (torch.from_numpy(table) for table in (rotations, height, share))
    return ContactObjects(names, surface_samplers([(name, 1.0) for name in names]), *tables)
