"""The networks in PyTorch behind the models of an episode: what NumPy is measured against."""

from pathlib import Path
from typing import Any

import torch
from torch import nn

from keypush.learning.checkpoint import NETWORKS, load_network
from keypush.learning.clips import Clips
from keypush.learning.inference.ops import Array, Index
from keypush.learning.model import PolicyModel
from keypush.learning.predict import fast_network, make_model
from keypush.learning.tensors import Tensors
from keypush.networks.surface_keypoint_network import NetworkInput, SurfaceKeypointNetwork


class EagerNetwork:
    """A network that PyTorch runs, one scene at a time; see `predict.Forward`."""

    def __init__(self, network: nn.Module) -> None:
        """Args: the network, in evaluation mode."""
        self._network = network

    @torch.inference_mode()
    def __call__(
        self, cloud: Array, centres: Index, members: Index, query: Array, hand: Array
    ) -> Array:
        """Maps a scene to the network's outputs; see `predict.Forward`."""
        p, c, m, q, h = (
            torch.from_numpy(array)[None] for array in (cloud, centres, members, query, hand)
        )
        if isinstance(self._network, SurfaceKeypointNetwork):
            output = self._network(NetworkInput(p, c, m, q[:, :2], q[:, 2:], h))
        else:
            output = self._network(p, c, m, h, q)
        array: Array = output[0].numpy()
        return array


def random_network(kind: str, sizes: Any, seed: int = 0) -> nn.Module:
    """Makes an untrained network of `checkpoint.NETWORKS`, whose weights follow from the seed.

    No layer is what it starts as: a norm that is the identity would hide a wrong gain or bias.
    """
    with torch.no_grad(), torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        network = NETWORKS[kind](sizes)
        for parameter in network.parameters():
            parameter.add_(0.1 * torch.randn_like(parameter))
    return network.eval()


def read_network(kind: str, weights: str | Path) -> nn.Module:
    """Reads a network of a kind; see `checkpoint.load_network`."""
    return load_network(weights, NETWORKS[kind])


def both_models(
    kind: str, network: Any, clips: Clips | None = None
) -> tuple[PolicyModel, PolicyModel]:
    """Returns the model as episodes run it, and the same in PyTorch; see `predict.make_model`."""
    arrays = {name: value.numpy() for name, value in network.state_dict().items()}
    fast = fast_network(kind, Tensors(kind, arrays), network.config)
    return (
        make_model(kind, fast, network.config, clips),
        make_model(kind, EagerNetwork(network), network.config, clips),
    )
