"""Weights of the keypoint network: `<name>.safetensors` and, beside it, `<name>.json`."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load, save

from keypush.errors import UserError, one_line
from keypush.learning.card import read_card, weights_path
from keypush.learning.network import KeypointNetwork
from keypush.learning.network_config import NetworkConfig


def save_network(network: KeypointNetwork, path: Path, record: dict[str, Any]) -> None:
    """Writes weights and their description; each file appears whole or not at all.

    Args:
        path: of the `.safetensors` file.
        record: what else to tell about the weights (training, metrics, ...), as JSON.
    """
    description = {"network": dataclasses.asdict(network.config), **record}
    write_atomically(path, save({k: v.contiguous() for k, v in network.state_dict().items()}))
    write_atomically(path.with_suffix(".json"), (json.dumps(description, indent=2) + "\n").encode())


def load_network(name_or_path: str | Path) -> KeypointNetwork:
    """Reads a network, in evaluation mode.

    Args:
        name_or_path: name of weights that ship with keypush, or path of a `.safetensors` file.

    Raises:
        UserError: a file is missing, unreadable, or does not fit the network.
    """
    path = weights_path(name_or_path)
    config = _read_config(path)
    network = KeypointNetwork(config)
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


def _read_config(weights: Path) -> NetworkConfig:
    try:
        return NetworkConfig(**read_card(weights)["network"])
    except (KeyError, TypeError) as error:
        raise UserError(
            f"weights' card {weights.with_suffix('.json')}: expected the sizes of the network "
            f"under 'network': {one_line(error)}"
        ) from error


def parameter_count(network: torch.nn.Module) -> int:
    """Counts the trained numbers."""
    return sum(parameter.numel() for parameter in network.parameters())
