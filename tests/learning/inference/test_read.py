"""Weights are read by PyTorch and by NumPy alike, and what is wrong with them is named."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from keypush.errors import UserError
from keypush.learning.card import trained_objects
from keypush.learning.checkpoint import load_network, save_network
from keypush.learning.eager import random_network
from keypush.networks.config import EncoderConfig, KeypointConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.keypoint_network import KeypointNetwork
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork
from tests.learning.scenes import SMALL, make_cloud, make_hand, read_keypoint_model

READERS: list[Callable[[Path], Any]] = [
    read_keypoint_model,
    lambda path: load_network(path, SurfaceKeypointNetwork),
]
Edit = Callable[[dict[str, Any]], Any]


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    path = tmp_path / "some.safetensors"
    save_network(random_network("surface_keypoint", SMALL), path, {})
    return path


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (lambda t: t.pop("context.bias"), r"missing: context\.bias"),
        (lambda t: t.update(more=np.zeros(2)), r"unexpected: more"),
        (
            lambda t: t.update({"query.0.weight": np.zeros((16, 5), dtype=np.float32)}),
            r"query\.0\.weight has shape \(16, 5\), expected \(16, 2\)",
        ),
        (lambda t: t.clear(), r"missing: .*, .*, .*, .* and \d+ more"),
    ],
)
def test_tensors_that_do_not_fit_are_named(
    weights: Path, edit: Edit, told: str, read: Callable[[Path], Any]
) -> None:
    tensors = load_file(weights)
    edit(tensors)
    save_file(tensors, weights)
    with pytest.raises(
        UserError, match=rf"^weights .*some\.safetensors: cannot be loaded: .*{told}"
    ):
        read(weights)


@pytest.mark.parametrize("read", READERS)
def test_a_damaged_file_is_named(weights: Path, read: Callable[[Path], Any]) -> None:
    weights.write_bytes(weights.read_bytes()[:100])
    with pytest.raises(UserError, match=r"some\.safetensors: cannot be loaded"):
        read(weights)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "no JSON"),
        ("[]", "found list; allowed: an object"),
        ("{}", "kind is ''; allowed: contact, keypoint, behavior_cloning, surface_keypoint"),
        ('{"kind": "surface_keypoint"}', "expected the sizes of the network under 'network'"),
        (
            '{"kind": "surface_keypoint", "network": {"no_such_size": 1}}',
            "expected the sizes of the network under 'network'",
        ),
        ('{"kind": "surface_keypoint", "network": 3}', "expected the sizes of the network"),
        ('{"kind": "surface_keypoint", "network": {"layers": "two"}}', "layers is 'two'; allowed"),
        (
            '{"kind": "surface_keypoint", "network": {"query_heads": 5}}',
            "query_heads is 5; allowed: a divisor of 128",
        ),
        ('{"kind": ["surface_keypoint"]}', r"kind is \['surface_keypoint'\]; allowed: contact"),
        ("[" * 100_000, "no JSON"),
        (
            '{"kind": "surface_keypoint", "network": {"patch_size": 10000000000000}}',
            "patch_size is 10000000000000; allowed: a whole number from 1 to 16384",
        ),
        (
            '{"kind": "surface_keypoint", "network": {"use_com": "yes"}}',
            "use_com is 'yes'; allowed: true or false",
        ),
    ],
)
def test_a_card_that_makes_no_network_is_named(
    weights: Path, text: str, told: str, read: Callable[[Path], Any]
) -> None:
    weights.with_suffix(".json").write_text(text)
    with pytest.raises(UserError, match=rf"some\.json: {told}"):
        read(weights)


@pytest.mark.parametrize(
    ("sizes", "told"),
    [
        ({"dropout": "x"}, "dropout is 'x'; allowed: 0 to 0.9"),
        ({"dropout": math.nan}, "dropout is nan; allowed: 0 to 0.9"),
        ({"patch_size": 33}, "patch_size is 33; allowed: a divisor of 512"),
        ({"layers": 17}, "layers is 17; allowed: a whole number from 1 to 16"),
    ],
)
def test_a_card_that_makes_no_encoder_is_named(
    weights: Path, sizes: dict[str, object], told: str
) -> None:
    save_network(random_network("contact", EncoderConfig()), weights, {})
    card = {"kind": "contact", "network": sizes}
    weights.with_suffix(".json").write_text(json.dumps(card))
    with pytest.raises(UserError, match=rf"some\.json: {told}"):
        load_network(weights, ContactNetwork)


def test_objects_that_are_no_names_are_told(weights: Path) -> None:
    save_network(random_network("surface_keypoint", SMALL), weights, {"data": {"objects": ["can"]}})
    assert trained_objects(weights) == {"can"}
    for wrong in (5, "can", [["can"]], None):
        card = json.dumps({"data": {"objects": wrong}})
        weights.with_suffix(".json").write_text(card)
        with pytest.raises(UserError, match=r"some\.json: data\.objects is .*; allowed: a list of"):
            trained_objects(weights)


@pytest.mark.parametrize("read", READERS)
def test_without_a_card_weights_are_refused(weights: Path, read: Callable[[Path], Any]) -> None:
    weights.with_suffix(".json").unlink()
    with pytest.raises(UserError, match=r"some\.json: cannot be read"):
        read(weights)


def test_weights_of_another_kind_are_refused(weights: Path) -> None:
    save_network(random_network("contact", EncoderConfig()), weights, {})
    with pytest.raises(UserError, match=r"kind is 'contact'; allowed here: keypoint, surface"):
        read_keypoint_model(weights)
    with pytest.raises(UserError, match=r"kind is 'contact'; allowed here: keypoint$"):
        load_network(weights, KeypointNetwork)


def test_missing_weights_are_named_with_those_of_the_kind() -> None:
    with pytest.raises(UserError, match=r"nothing\.safetensors; allowed: a name in .* \(contact\)"):
        load_network("nothing", ContactNetwork)
    with pytest.raises(UserError, match=r"no_such_weights.*allowed"):
        load_network("no_such_weights", SurfaceKeypointNetwork)


def test_what_is_read_predicts_what_was_saved(tmp_path: Path) -> None:
    path = tmp_path / "some.safetensors"
    for kind, sizes in (("surface_keypoint", SMALL), ("keypoint", KeypointConfig())):
        network = random_network(kind, sizes)
        save_network(network, path, {"seed": 3})
        assert sorted(p.name for p in tmp_path.iterdir()) == ["some.json", "some.safetensors"]
        assert json.loads(path.with_suffix(".json").read_text())["seed"] == 3
        read = load_network(path, type(network))
        for name, value in network.state_dict().items():
            np.testing.assert_array_equal(read.state_dict()[name], value)
        rng = np.random.default_rng(7)
        scene = make_cloud(rng), np.array([0.1, 0.0]), np.zeros(3), make_hand(rng)
        first, again = (read_keypoint_model(path).predict(*scene) for _ in range(2))
        np.testing.assert_array_equal(first, again)
