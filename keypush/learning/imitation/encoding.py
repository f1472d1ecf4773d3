"""Clouds of examples, and their tokens."""

import torch

from keypush.learning.clouds import CloudBank, Sampler, make_bank
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.examples import Examples
from keypush.networks.config import CLOUD_POINTS
from keypush.networks.normalisation import LENGTH
from keypush.networks.patch_encoder import PatchTransformerEncoder
from keypush.seeding import make_generator

EncoderInput = tuple[torch.Tensor, torch.Tensor, torch.Tensor, torch.Tensor]
"""Cloud, centres, members and hand; see `PatchTransformerEncoder`."""


def clouds_of(
    samplers: list[Sampler],
    per_object: int,
    encoder: PatchTransformerEncoder,
    config: ImitationConfig,
    draw: tuple[int, str],
) -> CloudBank:
    """Draws noisy clouds in O, in units of `normalisation.LENGTH`.

    Args:
        samplers: of the objects.
        per_object: clouds of each.
        encoder: its patches are made.
        config: seed and noise.
        draw: number and purpose of the draw.
    """
    patches = (encoder.config.patches, encoder.config.patch_size)
    rng = make_generator(config.seed, *draw)
    bank = make_bank(samplers, per_object, (CLOUD_POINTS, config.cloud_deviation), patches, rng)
    return CloudBank(bank.cloud / LENGTH, bank.centres, bank.members, bank.per_object)


def posed(
    examples: Examples, index: torch.Tensor, bank: CloudBank, entry: torch.Tensor
) -> EncoderInput:
    """Puts clouds of the bank, entries (B,), where some examples (B,) have their objects."""
    R_WO, p_WO = examples.R_WO[index], examples.p_WO[index]
    cloud = torch.bmm(bank.cloud[entry], R_WO.transpose(1, 2)) + p_WO[:, None]
    return cloud, bank.centres[entry], bank.members[entry], examples.hand[index]


def encode(encoder: PatchTransformerEncoder, scenes: EncoderInput, precision: str) -> torch.Tensor:
    """Returns tokens (B, T, WIDTH) of scenes, without gradients."""
    device = next(encoder.parameters()).device
    on_device = [tensor.to(device) for tensor in scenes]
    with (
        torch.no_grad(),
        torch.autocast(device.type, dtype=torch.bfloat16, enabled=precision == "bf16"),
    ):
        tokens: torch.Tensor = encoder(*on_device)
    return tokens
