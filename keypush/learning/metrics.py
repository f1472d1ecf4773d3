"""Errors of predicted keypoints."""

from collections.abc import Sequence

import torch

from keypush.learning.clouds import Sampler, draw_clouds
from keypush.learning.config import TrainingConfig
from keypush.learning.inference.goal_frame import LENGTH
from keypush.learning.scenes import SceneTable, to_network, with_clouds
from keypush.networks.surface_keypoint_network import NetworkInput, SurfaceKeypointNetwork
from keypush.seeding import make_generator

MOST_ROWS = 4096
"""Scenes that errors are measured on, at most."""


def evaluate(
    network: SurfaceKeypointNetwork,
    scenes: SceneTable,
    samplers: Sequence[Sampler],
    config: TrainingConfig,
) -> dict[str, float]:
    """Measures the errors on at most `MOST_ROWS` scenes, always with the same clouds.

    Returns:
        In m: mean and 90 % quantile of the distance (`error_mean`, `error_p90`) and of its
        horizontal part (`error_xy_mean`, `error_xy_p90`), the mean across the line of push
        (`error_lateral_mean`), and the mean horizontal error of the cloud's centroid
        (`centroid_xy_mean`) for comparison.
    """
    rng = make_generator(config.seed, 0, "validation")
    bank = draw_clouds(samplers, config, rng)
    generator = torch.Generator().manual_seed(int(rng.integers(2**62)))
    chosen = torch.from_numpy(rng.permutation(len(scenes))[:MOST_ROWS])
    errors, centroid = [], []
    device = next(network.parameters()).device
    with torch.inference_mode():
        for index in torch.split(chosen, config.batch):
            batch = with_clouds(scenes.take(index), bank, generator)
            scene, label = to_network(batch, use_com=config.network.use_com)
            on_device = NetworkInput(**{k: v.to(device) for k, v in vars(scene).items()})
            errors.append(LENGTH * (network(on_device).cpu() - label))
            centroid.append(LENGTH * (scene.cloud.mean(dim=1) - label)[:, :2].norm(dim=1))
    return {
        **keypoint_errors(torch.cat(errors)),
        "centroid_xy_mean": float(torch.cat(centroid).mean()),
    }


def keypoint_errors(error: torch.Tensor) -> dict[str, float]:
    """Sums up errors (n, 3) of keypoints in goal frames, in m; see `evaluate`."""
    distance, horizontal = error.norm(dim=1), error[:, :2].norm(dim=1)
    return {
        "rows": len(error),
        "error_mean": float(distance.mean()),
        "error_p90": float(distance.quantile(0.9)),
        "error_xy_mean": float(horizontal.mean()),
        "error_xy_p90": float(horizontal.quantile(0.9)),
        "error_lateral_mean": float(error[:, 1].abs().mean()),
    }
