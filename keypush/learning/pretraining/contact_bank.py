"""Clouds of objects of many sizes, with and without the sensor's noise."""

from dataclasses import dataclass

import numpy as np
import torch

from keypush.learning.clouds import CloudBank
from keypush.learning.inference.patches import group_patches
from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.contact_objects import ContactObjects
from keypush.networks.config import CLOUD_POINTS


@dataclass(frozen=True)
class ContactBank:
    """Clouds, and what they are clouds of.

    Attributes:
        clouds: with noise; patches are found on it, as they will be on a measured cloud.
        surface: the same points without noise, which decide what touches, (K * V, N, 3), m.
        size: factor on the object's own size, (K * V,).
    """

    clouds: CloudBank
    surface: torch.Tensor
    size: torch.Tensor


def draw_bank(
    objects: ContactObjects, samples: int, config: PretrainConfig, rng: np.random.Generator
) -> ContactBank:
    """Draws sizes, points and noise of `clouds_per_object` clouds of every object.

    Fewer, where there would be more clouds than samples.
    """
    count = len(objects.names)
    per_object = min(config.clouds_per_object, -(-samples // count))
    size = 1 + config.size_variation * rng.uniform(-1, 1, count * per_object)
    points = [draw(CLOUD_POINTS, rng) for draw in objects.samplers for _ in range(per_object)]
    surface = np.stack(points) * size[:, None, None]
    cloud = (surface + rng.normal(0, config.cloud_deviation, surface.shape)).astype(np.float32)
    encoder = config.encoder
    groups = [group_patches(one, encoder.patches, encoder.patch_size) for one in cloud]
    return ContactBank(
        clouds=CloudBank(
            cloud=torch.from_numpy(cloud),
            centres=torch.from_numpy(np.stack([centres for centres, _ in groups])),
            members=torch.from_numpy(np.stack([members for _, members in groups])),
            per_object=per_object,
        ),
        surface=torch.from_numpy(surface.astype(np.float32)),
        size=torch.from_numpy(size.astype(np.float32)),
    )
