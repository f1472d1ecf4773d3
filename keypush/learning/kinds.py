"""The kinds of networks that weights may be of, and their sizes as a card tells them."""

from collections.abc import Collection, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from keypush.errors import UserError, one_line
from keypush.learning.card import read_card
from keypush.networks.config import (
    CLOUD_POINTS,
    DROPOUT_RANGE,
    LARGEST,
    WIDTH,
    EncoderConfig,
    KeypointConfig,
    SurfaceConfig,
)

Sizes = EncoderConfig | KeypointConfig | SurfaceConfig

KINDS: Mapping[str, type[Sizes]] = {
    "contact": EncoderConfig,
    "keypoint": KeypointConfig,
    "behavior_cloning": KeypointConfig,
    "surface_keypoint": SurfaceConfig,
}
"""Configuration by the kind that the card names."""


def read_sizes(weights: Path, allowed: Collection[str]) -> tuple[str, Any]:
    """Reads the kind of a network and its configuration from the card of its weights.

    Args:
        weights: the `.safetensors` file.
        allowed: kinds.

    Raises:
        UserError: the card cannot be read, names another kind, or sizes that make no network.
    """
    card, told = read_card(weights), f"weights' card {weights.with_suffix('.json')}"
    kind = card.get("kind", "")
    if not isinstance(kind, str) or kind not in KINDS:
        raise UserError(f"{told}: kind is {kind!r}; allowed: {', '.join(KINDS)}")
    if kind not in allowed:
        raise UserError(f"weights {weights}: kind is {kind!r}; allowed here: {', '.join(allowed)}")
    try:
        sizes = _make_sizes(KINDS[kind], card["network"])
    except (KeyError, TypeError) as error:
        raise UserError(
            f"{told}: expected the sizes of the network under 'network': {one_line(error)}"
        ) from error
    check_sizes(sizes, f"{told}: ")
    return kind, sizes


def _make_sizes(config: type[Sizes], values: Mapping[str, Any]) -> Sizes:
    if config is KeypointConfig:
        return KeypointConfig(**{**values, "encoder": EncoderConfig(**values["encoder"])})
    return config(**values)


def check_sizes(sizes: Sizes, told: str) -> None:
    """Checks the sizes of a network.

    Args:
        sizes: as a card or an option tells them.
        told: where they stand, for the message.

    Raises:
        UserError: one of them makes no network.
    """
    for spec in fields(sizes):
        value = getattr(sizes, spec.name)
        if isinstance(value, EncoderConfig):
            check_sizes(value, told)
            continue
        fine, allowed = _judge(sizes, spec.name, type(spec.default), value)
        if not fine:
            raise UserError(f"{told}{spec.name} is {value!r}; allowed: {allowed}")


def _judge(sizes: Sizes, name: str, kind: type, value: Any) -> tuple[bool, str]:
    """Says whether a size can be one, and what is allowed; the sizes before it can."""
    if kind is bool:
        return type(value) is bool, "true or false"
    if kind is float:
        least, most = DROPOUT_RANGE
        return type(value) in (int, float) and least <= value <= most, f"{least:g} to {most:g}"
    whole = None
    if name.endswith("heads"):
        whole = getattr(sizes, "width", WIDTH)
    elif name == "patch_size" and isinstance(sizes, EncoderConfig):
        whole = CLOUD_POINTS
    if whole is not None:
        fine = type(value) is int and value >= 1 and whole % value == 0
        return fine, f"a divisor of {whole}"
    fine = type(value) is int and 1 <= value <= LARGEST[name]
    return fine, f"a whole number from 1 to {LARGEST[name]}"
