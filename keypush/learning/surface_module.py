"""How an epoch trains the surface network."""

from collections.abc import Iterator, Sequence
from typing import ClassVar, override

import torch

from keypush.learning.clouds import CloudBank, Sampler, draw_clouds
from keypush.learning.config import TrainingConfig
from keypush.learning.cosine_module import CosineModule
from keypush.learning.metrics import evaluate
from keypush.learning.scenes import SceneTable, augment, to_network, with_clouds
from keypush.networks.surface_keypoint_network import NetworkInput, SurfaceKeypointNetwork
from keypush.seeding import make_generator

Batch = tuple[tuple[torch.Tensor, ...], torch.Tensor]
"""Fields of a `NetworkInput`, and labels p_GK (B, 3)."""


class SurfaceModule(CosineModule):
    """New surface points, noise and augmentation in every epoch; the loss is the distance."""

    MONITOR: ClassVar[str] = "error_mean"
    config: TrainingConfig

    def __init__(
        self,
        config: TrainingConfig,
        scenes: SceneTable,
        validation: SceneTable,
        samplers: Sequence[Sampler],
    ) -> None:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(config.seed)
            network = SurfaceKeypointNetwork(config.network)
        super().__init__(network, config)
        self.surface = network
        self._scenes = scenes
        self._validation = validation
        self._samplers = samplers

    @override
    def batches(self, epoch: int) -> "_AugmentedBatches":
        """Draws that depend on seed and epoch alone."""
        rng = make_generator(self.config.seed, epoch, "training")
        bank = draw_clouds(self._samplers, self.config, rng)
        seed = int(rng.integers(2**62))
        order = torch.from_numpy(rng.permutation(len(self._scenes))[: self.config.rows_per_epoch])
        return _AugmentedBatches(self._scenes, self.share(order), bank, seed, self.config)

    @override
    def loss(self, batch: Batch) -> tuple[torch.Tensor, int]:
        """The mean distance, in units of `goal_frame.LENGTH`."""
        fields, label = batch
        distance = (self.network(NetworkInput(*fields)) - label).norm(dim=1)
        return distance.mean(), len(label)

    @override
    def errors(self) -> dict[str, float]:
        """See `metrics.evaluate`."""
        return evaluate(self.surface, self._validation, self._samplers, self.config)


class _AugmentedBatches:
    """Batches of one epoch, made when they are asked for."""

    def __init__(
        self,
        scenes: SceneTable,
        order: torch.Tensor,
        bank: CloudBank,
        seed: int,
        config: TrainingConfig,
    ) -> None:
        self._scenes = scenes
        self._parts = torch.split(order, config.batch)
        self._bank = bank
        self._seed = seed
        self._config = config

    def __len__(self) -> int:
        return len(self._parts)

    def __iter__(self) -> Iterator[Batch]:
        generator = torch.Generator().manual_seed(self._seed)
        for index in self._parts:
            batch = with_clouds(self._scenes.take(index), self._bank, generator)
            if self._config.augment:
                batch = augment(batch, generator)
            scene, label = to_network(batch, use_com=self._config.network.use_com)
            yield tuple(vars(scene).values()), label
