"""Noisy clouds of objects for training, rebuilt from the objects and grouped into patches."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from keypush.learning.config import TrainingConfig
from keypush.learning.patches import group_patches_batch
from keypush.objects.library import make_object

Sampler = Callable[[int, np.random.Generator], NDArray[np.float64]]
"""Draws points (count, 3) in O on an object's surface."""


@dataclass(frozen=True)
class CloudBank:
    """V clouds of each of K objects in O, in m.

    Patches follow from the cloud's own shape and not from its pose, so they are found once here,
    on the noisy cloud, and serve every pose.

    Attributes:
        cloud: (K * V, N, 3).
        centres: indices of patch centres, (K * V, patches).
        members: indices of patch points, (K * V, patches, patch_size).
        per_object: V.
    """

    cloud: torch.Tensor
    centres: torch.Tensor
    members: torch.Tensor
    per_object: int

    def choose(self, object_index: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
        """Chooses a random cloud of each object (B,): entries of the bank (B,)."""
        variant = torch.randint(self.per_object, object_index.shape, generator=generator)
        return object_index * self.per_object + variant


def surface_samplers(objects: Sequence[tuple[str, float]]) -> list[Sampler]:
    """Returns the samplers of catalogue objects given as (name, size ratio).

    Raises:
        UserError: a name is not in the catalogue.
    """
    return [make_object(name, size_ratio).surface_points for name, size_ratio in objects]


def draw_clouds(
    samplers: Sequence[Sampler], config: TrainingConfig, rng: np.random.Generator
) -> CloudBank:
    """Draws surface points and noise of `clouds_per_object` clouds per object and size.

    Where sizes are so many that a pass would not meet all of these clouds, fewer are drawn: as
    many in all as the pass has rows.
    """
    rows_each = -(-config.rows_per_epoch // len(samplers))
    network = config.network
    return make_bank(
        samplers,
        min(config.clouds_per_object, rows_each),
        (config.cloud_points, config.cloud_deviation),
        (network.patches, network.patch_size),
        rng,
    )


def make_bank(
    samplers: Sequence[Sampler],
    per_object: int,
    sensor: tuple[int, float],
    patches: tuple[int, int],
    rng: np.random.Generator,
) -> CloudBank:
    """Draws clouds and groups them.

    Args:
        samplers: of K objects.
        per_object: clouds of each.
        sensor: points of a cloud, and the standard deviation of every coordinate, m.
        patches: number of patches, and points of each.
        rng: draws points and noise.
    """
    points, deviation = sensor
    clouds = [sampler(points, rng) for sampler in samplers for _ in range(per_object)]
    noisy = np.stack(clouds) + rng.normal(0, deviation, (len(clouds), *clouds[0].shape))
    cloud = torch.from_numpy(noisy.astype(np.float32))
    groups = [group_patches_batch(part, *patches) for part in torch.split(cloud, 64)]
    return CloudBank(
        cloud=cloud,
        centres=torch.cat([centres for centres, _ in groups]),
        members=torch.cat([members for _, members in groups]),
        per_object=per_object,
    )
