"""Where the tokens of a batch come from: encoded anew, or once and for all (`token_cache`)."""

from collections.abc import Callable
from typing import Protocol, override

import torch

from keypush.learning.clouds import surface_samplers
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.encoding import clouds_of, encode, posed
from keypush.learning.imitation.examples import Examples
from keypush.networks.patch_encoder import PatchTransformerEncoder

Fetch = Callable[[torch.Tensor], torch.Tensor]
"""Returns the tokens (B, T, WIDTH) of examples (B,)."""
MOST_CLOUDS = 16_384
"""In memory at once: 10 kB each."""


class TokenSource(Protocol):
    """Gives the tokens of examples."""

    def epoch(self, number: int) -> Fetch:
        """For training in an epoch."""

    def validation(self) -> Fetch:
        """For measuring; the same whenever it is asked for."""


class FreshTokens(TokenSource):
    """Draws clouds and noise anew in every epoch and runs the encoder on every batch."""

    def __init__(
        self, examples: Examples, encoder: PatchTransformerEncoder, config: ImitationConfig
    ) -> None:
        self._examples = examples
        self._encoder = encoder
        self._config = config
        self._samplers = surface_samplers(examples.objects)

    @override
    def epoch(self, number: int) -> Fetch:
        return self._draw((number, "epoch_clouds"))

    @override
    def validation(self) -> Fetch:
        return self._draw((0, "validation_clouds"))

    def _draw(self, draw: tuple[int, str]) -> Fetch:
        pairs = len(self._samplers)
        most = min(-(-len(self._examples) // pairs), MOST_CLOUDS // pairs)
        count = max(1, min(self._config.clouds_per_object, most))
        bank = clouds_of(self._samplers, count, self._encoder, self._config, draw)
        generator = torch.Generator().manual_seed(self._config.seed)

        def fetch(index: torch.Tensor) -> torch.Tensor:
            entry = bank.choose(self._examples.object_index[index], generator)
            scenes = posed(self._examples, index, bank, entry)
            return encode(self._encoder, scenes, self._config.encoder_precision)

        return fetch
