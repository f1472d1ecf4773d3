"""Errors of the thesis' networks in m, mm and mrad."""

import torch

from keypush.learning.clips import Clips
from keypush.learning.metrics import keypoint_errors
from keypush.networks.normalisation import LENGTH


def summarise(error: torch.Tensor, direction: torch.Tensor, clips: Clips) -> dict[str, float]:
    """Sums up errors in the units of the targets.

    Args:
        error: of normalised keypoints (n, 3), or of actions in shares of their clips (n, 6).
        direction: unit vector from the COM to the goal, (n, 2).
        clips: of the action.

    Returns:
        The mean square `mse`; of keypoints in m: see `metrics.evaluate`; of actions the mean and
        the 90 % quantile of the length of the translation's error, mm, and of the rotation's,
        mrad.
    """
    mse = {"mse": float(error.square().mean())}
    if error.shape[1] == 3:
        return {**mse, **keypoint_errors(_along_push(LENGTH * error, direction))}
    translation = 1e3 * clips.translation * error[:, :3].norm(dim=1)
    rotation = 1e3 * clips.rotation * error[:, 3:].norm(dim=1)
    return {
        **mse,
        "rows": len(error),
        "translation_mm_mean": float(translation.mean()),
        "translation_mm_p90": float(translation.quantile(0.9)),
        "rotation_mrad_mean": float(rotation.mean()),
        "rotation_mrad_p90": float(rotation.quantile(0.9)),
    }


def _along_push(error: torch.Tensor, direction: torch.Tensor) -> torch.Tensor:
    """Turns vectors (n, 3) of W to the frame whose x points from the COM to the goal, z up."""
    x, y = direction.unbind(dim=1)
    along = error[:, 0] * x + error[:, 1] * y
    across = error[:, 1] * x - error[:, 0] * y
    return torch.stack([along, across, error[:, 2]], dim=1)
