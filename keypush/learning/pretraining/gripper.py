"""The gripper's shape, for many points at once: the boxes of `hand_shape`, which the plant has."""

import torch

from keypush.robot.hand_shape import FINGERS, PALM

_BOXES = (PALM, FINGERS)
_CENTRES = torch.tensor([box.centre for box in _BOXES])
_HALVES = torch.tensor([box.size for box in _BOXES]) / 2
CORE = torch.tensor(FINGERS.centre)
"""A point in E inside the gripper, (3,), m."""


def inside(p_E: torch.Tensor) -> torch.Tensor:
    """Whether points (..., 3) in E, in m, are inside palm or fingers, (...)."""
    return ((p_E[..., None, :] - _CENTRES).abs() <= _HALVES).all(dim=-1).any(dim=-1)


def nearest(p_E: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Finds the nearest points of the gripper.

    Args:
        p_E: points (..., 3) in E, m.

    Returns:
        Distances (...), m, 0 inside; and the points of the gripper (..., 3) in E.
    """
    offset = p_E[..., None, :] - _CENTRES
    beyond = offset - torch.minimum(torch.maximum(offset, -_HALVES), _HALVES)
    square, box = beyond.square().sum(dim=-1).min(dim=-1)
    chosen = box[..., None, None].expand(*box.shape, 1, 3)
    return square.sqrt(), p_E - beyond.gather(-2, chosen)[..., 0, :]


def way_to(p_E: torch.Tensor, v_E: torch.Tensor) -> torch.Tensor:
    """How far points move along a direction until they enter the gripper.

    Args:
        p_E: points (B, N, 3) in E, m, outside.
        v_E: unit vectors (B, 3) in E.

    Returns:
        (B, N), m; infinite for points that miss it.
    """
    # Source: Kay and Kajiya, "Ray Tracing Complex Scenes", 1986: intersection with slabs.
    speed = v_E[:, None, None]
    speed = torch.where(speed.abs() < 1e-9, 1e-9, speed)
    offset = p_E[..., None, :] - _CENTRES
    one, other = (-_HALVES - offset) / speed, (_HALVES - offset) / speed
    enter = torch.minimum(one, other).amax(dim=-1)
    leave = torch.maximum(one, other).amin(dim=-1)
    hit = (enter <= leave) & (enter >= 0)
    return torch.where(hit, enter, torch.inf).amin(dim=-1)
