"""Scenes that look like the task: an object stands on the table, the hand pushes or comes near.

The encoder is frozen afterwards, so it has to have seen what it will be given.
"""

import math

import torch

from keypush.learning.pretraining.gripper import way_to
from keypush.learning.pretraining.poses import Poses
from keypush.learning.pretraining.rotations import tool_rotations, turns_about_z

REACH = torch.tensor([0.16, 0.20])
"""Half-sides of the part of the table that objects are on, m: 0.8 of the table's."""
NEAR_SHARE = 0.6
"""Share of the scenes in which the hand is about to touch, touches or has just touched."""
NEAR_OVERLAP = (0.005, 0.015)
"""Mean and standard deviation of how far such a hand is beyond the first touch, m."""
NEAR_HEIGHTS = (0.005, 0.05)
"""Of the tool tip over the table while it pushes, m: the expert's is 0.015."""
PITCHES = (math.radians(50), math.radians(90))
"""Of the tool below the table plane: the expert has 60 to 80 degrees."""
OTHER_YAW_SHARE = 0.25
"""Share of the hands whose finger row is not across the push; in the thesis it lies along it."""
FAR_GAP = 0.25
"""Greatest distance along the push of a hand that is not near, m."""
FAR_DEVIATION = 0.05
"""Standard deviation of its distance across the push, m."""
FAR_HEIGHTS = (0.015, 0.6)
"""Of its tool tip, m: low ones are more frequent; an episode starts as high as 0.7."""


def task_scenes(
    p_OP: torch.Tensor, R_rest: torch.Tensor, height: torch.Tensor, rng: torch.Generator
) -> Poses:
    """Draws scenes.

    Args:
        p_OP: surface points (B, N, 3) in O of the object in each, m, without noise.
        R_rest: rotations (B, 3, 3) with which they rest on the table.
        height: of Oo above the table then, (B,), m.
        rng: draws.
    """
    count = len(p_OP)

    def draw(low: float, high: float) -> torch.Tensor:
        return low + (high - low) * torch.rand(count, generator=rng)

    R_WO = torch.bmm(turns_about_z(draw(0, 2 * math.pi)), R_rest)
    xy = (2 * torch.rand(count, 2, generator=rng) - 1) * REACH
    p_WO = torch.cat([xy, height[:, None]], dim=1)
    azimuth = draw(0, 2 * math.pi)
    d_W = torch.stack([azimuth.cos(), azimuth.sin(), torch.zeros(count)], dim=1)
    side = torch.where(draw(0, 1) < 0.5, -1.0, 1.0)
    wrist_yaw = torch.where(draw(0, 1) < OTHER_YAW_SHARE, draw(0, math.pi / 2), math.pi / 2)
    R_WE = tool_rotations(d_W, draw(*PITCHES), side, wrist_yaw)
    # Every push aims at some point of the object.
    aim = torch.bmm(p_OP[:, :1], R_WO.transpose(1, 2))[:, 0] + p_WO
    near = _near(Poses(R_WO, p_WO, R_WE, _at_height(aim, draw(*NEAR_HEIGHTS))), p_OP, d_W, rng)
    low, high = FAR_HEIGHTS
    far = (
        _at_height(aim, low + (high - low) * draw(0, 1).square()) - draw(0, FAR_GAP)[:, None] * d_W
    )
    far[:, :2] += FAR_DEVIATION * torch.randn(count, 2, generator=rng)
    chosen = (draw(0, 1) < NEAR_SHARE) & near.isfinite().all(dim=1)
    return Poses(R_WO, p_WO, R_WE, torch.where(chosen[:, None], near, far))


def _near(
    over_aim: Poses, p_OP: torch.Tensor, d_W: torch.Tensor, rng: torch.Generator
) -> torch.Tensor:
    """Positions p_WE (B, 3) a little beyond the first touch; not finite where there is none."""
    back = over_aim.p_WE - d_W
    start = Poses(over_aim.R_WO, over_aim.p_WO, over_aim.R_WE, back)
    # The hand moves along d, so the object moves against it in E.
    v_E = -torch.einsum("bji,bj->bi", over_aim.R_WE, d_W)
    touch = way_to(start.to_hand(p_OP), v_E).amin(dim=1)
    mean, deviation = NEAR_OVERLAP
    beyond = mean + deviation * torch.randn(len(touch), generator=rng)
    return back + (touch + beyond)[:, None] * d_W


def _at_height(p_W: torch.Tensor, height: torch.Tensor) -> torch.Tensor:
    return torch.cat([p_W[:, :2], height[:, None]], dim=1)
