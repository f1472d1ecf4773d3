"""The clouds that were measured in an episode: not stored, but rebuilt bit for bit."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from keypush.objects.library import make_object
from keypush.objects.point_cloud import measured_cloud, sensed_points
from keypush.scenario import NoiseConfig

Array = NDArray[np.float64]


def episode_clouds(noise: NoiseConfig, told: Mapping[str, Any], poses: Array) -> Array:
    """Rebuilds the clouds of an episode's first n frames.

    Args:
        noise: the scenario's; how many points and how noisy.
        told: of the episode: object, size_ratio, seed and episode.
        poses: X_WO of its frames from the first on, (n, 7) with float64 as they were stored.

    Returns:
        (n, N, 3) points p_WP, m: what the sensor gave to the policy, to the last bit.

    Raises:
        UserError: the object is not there any more.
    """
    seed, episode = int(told["seed"]), int(told["episode"])
    points = _points(str(told["object"]), float(told["size_ratio"]), noise.cloud_points, seed)
    clouds = [
        measured_cloud(points, pose, noise.cloud_deviation, seed, episode, step)
        for step, pose in enumerate(poses)
    ]
    return np.array(clouds).reshape(-1, noise.cloud_points, 3)


@lru_cache(maxsize=64)
def _points(name: str, size_ratio: float, count: int, seed: int) -> Array:
    return sensed_points(make_object(name, size_ratio), count, seed)
