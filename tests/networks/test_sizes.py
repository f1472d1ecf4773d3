"""The networks have the parameters that CORN's code and the thesis' tables give."""

import pytest
from torch import nn

from keypush.networks.config import EncoderConfig, KeypointConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.keypoint_network import BehaviorCloningNetwork, KeypointNetwork


def _count(module: nn.Module) -> int:
    return sum(parameter.numel() for parameter in module.parameters())


@pytest.mark.parametrize(
    ("patch_size", "layers", "encoder"),
    [(32, 2, 374_909), (32, 3, 491_005), (16, 2, 362_621), (16, 3, 478_717)],
)
def test_the_contact_network_has_corns_parameters(
    patch_size: int, layers: int, encoder: int
) -> None:
    network = ContactNetwork(EncoderConfig(patch_size=patch_size, layers=layers))
    assert _count(network.encoder) == encoder
    assert _count(network.decoder) == 33_665


@pytest.mark.parametrize("heads", [8, 16])
@pytest.mark.parametrize(("use_com", "count"), [(True, 125_827), (False, 125_059)])
def test_the_head_has_the_thesis_parameters(heads: int, use_com: bool, count: int) -> None:
    config = KeypointConfig(use_com=use_com, heads=heads)
    assert _count(KeypointNetwork(config).head) == count
    assert _count(BehaviorCloningNetwork(config).head) == count + 3 * 65
