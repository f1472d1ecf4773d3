"""How an epoch trains one of the thesis' heads."""

from collections.abc import Iterator
from typing import ClassVar, override

import torch
from torch.nn import functional

from keypush.learning.clips import Clips
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.errors import summarise
from keypush.learning.imitation.examples import Examples
from keypush.learning.imitation.selection import Selection
from keypush.learning.imitation.token_source import Fetch, TokenSource
from keypush.learning.lightning_run import EpochModule
from keypush.networks.keypoint_network import BehaviorCloningNetwork, KeypointNetwork
from keypush.seeding import make_generator

Batch = tuple[torch.Tensor, torch.Tensor, torch.Tensor]
"""Tokens (B, T, WIDTH), queries (B, 2 or 5), targets (B, 3 or 6)."""
_MEASURED_AT_ONCE = 1024


class ImitationModule(EpochModule):
    """Mean squared error on tokens of a frozen encoder.

    Attributes:
        head: what is trained of the network.
        examples: all that were selected.
        train_rows: places of those that are trained on.
        tokens: where their tokens come from.
    """

    MONITOR: ClassVar[str] = "mse"
    config: ImitationConfig

    def __init__(
        self,
        network: KeypointNetwork | BehaviorCloningNetwork,
        examples: Examples,
        selection: Selection,
        tokens: TokenSource,
        clips: Clips,
        config: ImitationConfig,
    ) -> None:
        super().__init__(network, config)
        self.head = network.head
        self.examples = examples
        self.train_rows = torch.from_numpy(selection.train)
        self._validation = torch.from_numpy(selection.validation)
        self._held_out = torch.from_numpy(selection.some_held_out())
        self.tokens = tokens
        self._clips = clips

    @override
    def batches(self, epoch: int) -> "_TokenBatches":
        """Every row once, in an order that depends on seed and epoch alone."""
        rng = make_generator(self.config.seed, epoch, "order")
        order = self.share(self.train_rows[torch.from_numpy(rng.permutation(len(self.train_rows)))])
        return _TokenBatches(
            self.examples, torch.split(order, self.config.batch), self.tokens.epoch(epoch)
        )

    @override
    def loss(self, batch: Batch) -> tuple[torch.Tensor, int]:
        """The mean squared error, in the units of the targets."""
        tokens, query, target = batch
        return functional.mse_loss(self.head(tokens.to(query.dtype), query), target), len(target)

    @override
    def errors(self) -> dict[str, float]:
        """See `errors.summarise`; where objects are held out, theirs as `held_out_...`, too."""
        others = self.measure(self._held_out) if len(self._held_out) else {}
        return {
            **self.measure(self._validation),
            **{f"held_out_{name}": value for name, value in others.items()},
        }

    def measure(self, index: torch.Tensor) -> dict[str, float]:
        """Measures the network on some examples."""
        fetch, errors = self.tokens.validation(), []
        with torch.inference_mode():
            for part in torch.split(index, _MEASURED_AT_ONCE):
                tokens = fetch(part).to(self.device).float()
                output = self.head(tokens, self.examples.query[part].to(self.device))
                errors.append(output.cpu() - self.examples.target[part])
        return summarise(torch.cat(errors), self.examples.direction[index], self._clips)

    @override
    def learning_rate(self, epochs: float) -> float:
        """Halved again and again."""
        return self.config.rate_after(epochs)

    @override
    def configure_optimizers(self) -> torch.optim.Optimizer:
        """AdamW on the head."""
        return torch.optim.AdamW(
            self.head.parameters(),
            lr=self.config.learning_rate,
            weight_decay=self.config.weight_decay,
            fused=True,
        )


class _TokenBatches:
    """Batches of one epoch, made when they are asked for."""

    def __init__(self, examples: Examples, parts: tuple[torch.Tensor, ...], fetch: Fetch) -> None:
        self._examples = examples
        self._parts = parts
        self._fetch = fetch

    def __len__(self) -> int:
        return len(self._parts)

    def __iter__(self) -> Iterator[Batch]:
        for index in self._parts:
            yield self._fetch(index), self._examples.query[index], self._examples.target[index]
