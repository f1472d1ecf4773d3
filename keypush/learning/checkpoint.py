"""Weights of a network: `<name>.safetensors` and, beside it, its card `<name>.json`."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import nn

from keypush.errors import UserError, one_line
from keypush.learning.card import read_card, weights_path
from keypush.networks.config import EncoderConfig, KeypointConfig, SurfaceConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.keypoint_network import BehaviorCloningNetwork, KeypointNetwork
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork

NETWORKS: Mapping[str, tuple[type[nn.Module], type[Any]]] = {
    "contact": (ContactNetwork, EncoderConfig),
    "keypoint": (KeypointNetwork, KeypointConfig),
    "behavior_cloning": (BehaviorCloningNetwork, KeypointConfig),
    "surface_keypoint": (SurfaceKeypointNetwork, SurfaceConfig),
}
"""Network and configuration by the kind that the card names."""


def save_network(network: nn.Module, path: Path, record: Mapping[str, Any]) -> None:
    """Writes weights and their description; each file appears whole or not at all.

    Args:
        network: one of `NETWORKS`.
        path: of the `.safetensors` file.
        record: what else to tell about the weights (training, metrics, ...), as JSON.
    """
    kind = next(name for name, (known, _) in NETWORKS.items() if type(network) is known)
    config: Any = network.config
    description = {"kind": kind, "network": dataclasses.asdict(config), **record}
    write_atomically(path, save({k: v.contiguous() for k, v in network.state_dict().items()}))
    write_atomically(path.with_suffix(".json"), (json.dumps(description, indent=2) + "\n").encode())


def load_network[Network: nn.Module](name_or_path: str | Path, wanted: type[Network]) -> Network:
    """Reads a network of a wanted kind, in evaluation mode.

    Args:
        name_or_path: name of weights that ship with keypush, or path of a `.safetensors` file.
        wanted: its class.

    Raises:
        UserError: a file is missing, unreadable, of another kind, or does not fit the network.
    """
    path = weights_path(name_or_path)
    network = _make_network(path, wanted)
    try:
        network.load_state_dict(load(path.read_bytes()))
    except (OSError, SafetensorError, RuntimeError) as error:
        raise UserError(f"weights {path}: cannot be loaded: {one_line(error)}") from error
    return network.eval()


def write_atomically(path: Path, content: bytes) -> None:
    """Writes a file through a temporary one, so that no reader sees half of it.

    Raises:
        UserError: the folder cannot be written.
    """
    temporary = path.with_name(path.name + ".tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {one_line(error)}") from error


def _make_network[Network: nn.Module](weights: Path, wanted: type[Network]) -> Network:
    card = read_card(weights)
    kind = card.get("kind", "")
    if kind not in NETWORKS:
        raise UserError(
            f"weights' card {weights.with_suffix('.json')}: kind is {kind!r}; "
            f"allowed: {', '.join(NETWORKS)}"
        )
    network, config = NETWORKS[kind]
    if not issubclass(network, wanted):
        kinds = [name for name, (known, _) in NETWORKS.items() if issubclass(known, wanted)]
        raise UserError(f"weights {weights}: kind is {kind!r}; allowed here: {', '.join(kinds)}")
    try:
        made: Network = network(_make_config(config, card["network"]))
    except (KeyError, TypeError) as error:
        raise UserError(
            f"weights' card {weights.with_suffix('.json')}: expected the sizes of the network "
            f"under 'network': {one_line(error)}"
        ) from error
    return made


def _make_config(config: type[Any], values: Mapping[str, Any]) -> Any:
    if config is KeypointConfig:
        return KeypointConfig(**{**values, "encoder": EncoderConfig(**values["encoder"])})
    return config(**values)


def parameter_count(network: torch.nn.Module) -> int:
    """Counts the trained numbers."""
    return sum(parameter.numel() for parameter in network.parameters())
