"""Labelled contact scenes, drawn when they are asked for."""

from collections.abc import Iterator

import torch

from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.contact_bank import ContactBank, draw_bank
from keypush.learning.pretraining.contact_objects import ContactObjects
from keypush.learning.pretraining.gripper import inside
from keypush.learning.pretraining.poses import Poses, join
from keypush.learning.pretraining.random_scenes import random_scenes
from keypush.learning.pretraining.task_scenes import task_scenes
from keypush.networks.normalisation import CENTRE_HEIGHT, LENGTH
from keypush.seeding import make_generator

ContactBatch = tuple[torch.Tensor, torch.Tensor, torch.Tensor, torch.Tensor, torch.Tensor]
"""Normalised cloud, centres, members and hand, as the encoder takes them; then whether each patch
touches the gripper, 0 or 1, (B, patches)."""
_CENTRE = torch.tensor([0.0, 0.0, CENTRE_HEIGHT])


class ContactBatches:
    """The batches of one draw: each follows from seed, draw and its own number alone."""

    def __init__(
        self,
        objects: ContactObjects,
        config: PretrainConfig,
        draw: tuple[int, str],
        samples: int,
        numbers: torch.Tensor | None = None,
    ) -> None:
        """Draws the clouds.

        Args:
            objects: every scene has one of them, all equally often.
            config: settings.
            draw: number and purpose of the draw.
            samples: scenes in all.
            numbers: which of the batches to make; None: all.
        """
        self._objects = objects
        self._config = config
        self._draw = draw
        self._samples = samples
        count = -(-samples // config.batch)
        self._numbers = torch.arange(count) if numbers is None else numbers
        self._bank = draw_bank(objects, samples, config, make_generator(config.seed, *draw))

    def __len__(self) -> int:
        return len(self._numbers)

    def __iter__(self) -> Iterator[ContactBatch]:
        for number in self._numbers.tolist():
            size = min(self._config.batch, self._samples - number * self._config.batch)
            # Step 0 drew the clouds.
            rng = make_generator(self._config.seed, *self._draw, step=number + 1)
            generator = torch.Generator().manual_seed(int(rng.integers(2**62)))
            yield draw_batch(self._objects, self._bank, size, self._config, generator)


def draw_batch(
    objects: ContactObjects,
    bank: ContactBank,
    size: int,
    config: PretrainConfig,
    rng: torch.Generator,
) -> ContactBatch:
    """Draws scenes: random ones first, then those that look like the task."""
    index = torch.randint(len(objects.names), (size,), generator=rng)
    entry = bank.clouds.choose(index, rng)
    p_OP = bank.surface[entry]
    tasks = int(torch.binomial(torch.tensor(float(size)), torch.tensor(config.task_share), rng))
    split = size - tasks
    R_rest, height = objects.rest(index[split:], rng)
    height = height * bank.size[entry[split:]]
    poses = join(
        random_scenes(p_OP[:split], config, rng),
        task_scenes(p_OP[split:], R_rest, height, rng),
    )
    return _to_network(bank, entry, poses)


def patch_labels(p_EP: torch.Tensor, members: torch.Tensor) -> torch.Tensor:
    """Whether any point of a patch is inside the gripper.

    Args:
        p_EP: points (B, N, 3) in E, m, without noise.
        members: indices of the points of patches (B, patches, patch_size).

    Returns:
        0 or 1, (B, patches).
    """
    rows = torch.arange(len(p_EP))[:, None, None]
    return inside(p_EP)[rows, members].any(dim=2).float()


def _to_network(bank: ContactBank, entry: torch.Tensor, poses: Poses) -> ContactBatch:
    members = bank.clouds.members[entry]
    hand = poses.hand()
    hand[:, :3] = (hand[:, :3] - _CENTRE) / LENGTH
    return (
        (poses.to_world(bank.clouds.cloud[entry]) - _CENTRE) / LENGTH,
        bank.clouds.centres[entry],
        members,
        hand,
        patch_labels(poses.to_hand(bank.surface[entry]), members),
    )
