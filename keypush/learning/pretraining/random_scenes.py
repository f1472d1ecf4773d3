"""Gripper and object anywhere, turned anyhow, near contact: CORN's scenes.

Source: Cho et al., ICLR 2024, and its pkm/scripts/pretrain/gen_col/gen_col.py.
"""

from dataclasses import replace

import torch

from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.gripper import CORE, nearest
from keypush.learning.pretraining.poses import Poses
from keypush.learning.pretraining.rotations import random_rotations

BOX = torch.tensor([0.48, 0.60, 0.30])
"""Sides in W of the box, centred over the table and standing on it, that positions are drawn in."""
MOST_LIFT = 0.1
"""Greatest height of the object's lowest point above the table, m, before the shift."""


def random_scenes(p_OP: torch.Tensor, config: PretrainConfig, rng: torch.Generator) -> Poses:
    """Draws scenes.

    Args:
        p_OP: surface points (B, N, 3) in O of the object in each, m, without noise.
        config: overlap and shift.
        rng: draws.
    """
    count = len(p_OP)
    positions = (torch.rand(2, count, 3, generator=rng) - torch.tensor([0.5, 0.5, 0.0])) * BOX
    rotations = random_rotations(2 * count, rng).view(2, count, 3, 3)
    poses = Poses(rotations[0], positions[0], rotations[1], positions[1])
    overlap = torch.randn(count, generator=rng) * config.overlap_deviation + config.overlap_mean
    poses = replace(poses, p_WO=poses.p_WO + _approach(p_OP, poses, overlap))
    shift = torch.randn(count, 3, generator=rng) * config.shift_deviation
    lowest = poses.to_world(p_OP)[..., 2].amin(dim=1)
    shift[:, 2] += torch.rand(count, generator=rng) * MOST_LIFT - lowest
    return replace(poses, p_WO=poses.p_WO + shift, p_WE=poses.p_WE + shift)


def _approach(p_OP: torch.Tensor, poses: Poses, overlap: torch.Tensor) -> torch.Tensor:
    """The motion (B, 3) in W of the object along the line of nearest points, by distance and more.

    Where object and gripper overlap already there is no such line, and the object's most inner
    point goes on towards the middle of the fingers.
    """
    p_E = poses.to_hand(p_OP)
    distance, p_EG = nearest(p_E)
    gap, index = distance.min(dim=1)
    chosen = index[:, None, None].expand(-1, 1, 3)
    from_point = p_E.gather(1, chosen)[:, 0]
    to_gripper = torch.where(
        gap[:, None] > 1e-6, p_EG.gather(1, chosen)[:, 0] - from_point, CORE - from_point
    )
    direction = to_gripper / to_gripper.norm(dim=1, keepdim=True).clamp_min(1e-9)
    return torch.einsum("bij,bj->bi", poses.R_WE, direction * (gap + overlap)[:, None])
