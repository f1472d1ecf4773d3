"""Weights of a network: `<name>.safetensors` and, beside it, its card `<name>.json`."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save
from torch import nn

from keypush.atomic_file import write_whole
from keypush.errors import UserError
from keypush.learning.card import read_card, weights_path
from keypush.learning.kinds import read_sizes
from keypush.learning.tensors import ENCODER, Tensors
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.keypoint_network import BehaviorCloningNetwork, KeypointNetwork
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork

NETWORKS: Mapping[str, type[nn.Module]] = {
    "contact": ContactNetwork,
    "keypoint": KeypointNetwork,
    "behavior_cloning": BehaviorCloningNetwork,
    "surface_keypoint": SurfaceKeypointNetwork,
}
"""Network by the kind that the card names; their configurations are in `kinds.KINDS`."""


def save_network(network: nn.Module, path: Path, record: Mapping[str, Any]) -> None:
    """Writes weights and their description; each file appears whole or not at all.

    Where the same weights lie there already, the description keeps who made them: a finished
    training that is started once more makes nothing.

    Args:
        network: one of `NETWORKS`.
        path: of the `.safetensors` file.
        record: what else to tell about the weights (training, metrics, ...), as JSON; where it
            names an `encoder` (`tensors.encoder_record`) that one is not written once more.
    """
    kind = next(name for name, known in NETWORKS.items() if type(network) is known)
    config: Any = network.config
    elsewhere = ENCODER if "encoder" in record else ()
    state = network.state_dict().items()
    content = save({k: v.contiguous() for k, v in state if not k.startswith(elsewhere)})
    made_by = _made_by(path) if path.is_file() and path.read_bytes() == content else {}
    description = {"kind": kind, "network": dataclasses.asdict(config), **record, **made_by}
    write_whole(path, content)
    write_whole(path.with_suffix(".json"), (json.dumps(description, indent=2) + "\n").encode())


def _made_by(path: Path) -> dict[str, Any]:
    try:
        card = read_card(path)
    except UserError:
        return {}
    return {name: card[name] for name in ("git_revision", "command") if name in card}


def load_network[Network: nn.Module](name_or_path: str | Path, wanted: type[Network]) -> Network:
    """Reads a network of a wanted kind, in evaluation mode.

    Args:
        name_or_path: name of weights that ship with keypush, or path of a `.safetensors` file.
        wanted: its class.

    Raises:
        UserError: a file is missing, unreadable, of another kind, or does not fit the network.
    """
    allowed = [kind for kind, known in NETWORKS.items() if issubclass(known, wanted)]
    path = weights_path(name_or_path, allowed)
    kind, sizes = read_sizes(path, allowed)
    network = NETWORKS[kind](sizes)
    assert isinstance(network, wanted)
    tensors = Tensors.read(path)
    state = network.state_dict()
    found = {name: tensors.take(name, *value.shape) for name, value in state.items()}
    tensors.finish()
    network.load_state_dict({name: torch.from_numpy(array) for name, array in found.items()})
    return network.eval()


def parameter_count(network: torch.nn.Module) -> int:
    """Counts the trained numbers."""
    return sum(parameter.numel() for parameter in network.parameters())
