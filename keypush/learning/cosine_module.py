"""What trainings share that take AdamW with a warm-up and one cosine."""

from typing import override

import numpy as np
import torch

from keypush.learning.lightning_run import EpochModule


class CosineModule(EpochModule):
    """An `EpochModule` whose learning rate rises and then falls to 0."""

    @override
    def learning_rate(self, epochs: float) -> float:
        """Warm-up, then cosine."""
        return self.config.learning_rate * rate(epochs / self.config.epochs)

    @override
    def configure_optimizers(self) -> torch.optim.Optimizer:
        """AdamW."""
        return torch.optim.AdamW(
            self.network.parameters(),
            lr=self.config.learning_rate,
            weight_decay=self.config.weight_decay,
            foreach=True,  # Lightning clips no gradients for a fused one
        )


def rate(done: float) -> float:
    """The share of the peak learning rate when a share `done` of the steps is behind."""
    warm_up = 0.05
    if done < warm_up:
        return (done + 0.001) / (warm_up + 0.001)
    return float(0.5 + 0.5 * np.cos(np.pi * (done - warm_up) / (1 - warm_up)))
