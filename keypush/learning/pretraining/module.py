"""How an epoch trains the contact network."""

import time
from typing import ClassVar, override

import torch
from torch.nn import functional

from keypush.learning.cosine_module import CosineModule
from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.contact_objects import ContactObjects
from keypush.learning.pretraining.contact_scenes import ContactBatch, ContactBatches
from keypush.learning.pretraining.scores import score_network
from keypush.networks.contact_network import ContactNetwork


class ContactModule(CosineModule):
    """New scenes in every epoch; the loss is the binary cross-entropy of patches in contact."""

    MONITOR: ClassVar[str] = "bce"
    config: PretrainConfig

    def __init__(self, objects: ContactObjects, config: PretrainConfig) -> None:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(config.seed)
            network = ContactNetwork(config.encoder)
        super().__init__(network, config)
        self.contact = network
        self._objects = objects
        self._positive_weight = torch.tensor(config.positive_weight)
        self._started = 0.0

    @override
    def batches(self, epoch: int) -> ContactBatches:
        """Scenes that depend on seed and epoch alone."""
        samples = self.config.samples_per_epoch
        numbers = self.share(torch.arange(-(-samples // self.config.batch)))
        return ContactBatches(self._objects, self.config, (epoch, "contact"), samples, numbers)

    @override
    def train_dataloader(self) -> ContactBatches:
        """Asked for anew in every epoch; its time begins here, because the clouds are drawn."""
        self._started = time.perf_counter()
        return super().train_dataloader()  # type: ignore[return-value]  # what `batches` returns

    @override
    def loss(self, batch: ContactBatch) -> tuple[torch.Tensor, int]:
        """The mean over patches and scenes."""
        cloud, centres, members, hand, label = batch
        logits = self.network(cloud, centres, members, hand)
        weight = self._positive_weight.to(logits.device)
        loss = functional.binary_cross_entropy_with_logits(logits.float(), label, pos_weight=weight)
        return loss, len(label)

    @override
    def errors(self) -> dict[str, float]:
        """Scores on scenes that are not trained on, always the same ones, and the speed."""
        seconds = time.perf_counter() - self._started
        draw = (0, "contact_validation")
        batches = ContactBatches(self._objects, self.config, draw, self.config.validation_samples)
        scores = score_network(self.contact, batches)
        del scores["reliability"]
        return {**scores, "samples_per_second": self.config.samples_per_epoch / seconds}
