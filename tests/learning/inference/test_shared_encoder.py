"""A head's weights name the file of the encoder that they stand on."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from keypush.errors import UserError
from keypush.learning.checkpoint import load_network, save_network
from keypush.learning.clips import Clips
from keypush.learning.eager import random_network
from keypush.learning.tensors import encoder_record
from keypush.networks.config import EncoderConfig, KeypointConfig
from keypush.networks.keypoint_network import KeypointNetwork
from tests.learning.scenes import make_cloud, make_hand, read_keypoint_model

READERS: list[Callable[[Path], Any]] = [
    read_keypoint_model,
    lambda path: load_network(path, KeypointNetwork),
]


@pytest.fixture
def head(tmp_path: Path) -> Path:
    """Saves a head on the encoder beside it, and the same network whole as `whole`."""
    contact: Any = random_network("contact", EncoderConfig(), seed=1)
    save_network(contact, tmp_path / "contact.safetensors", {})
    network: Any = random_network("keypoint", KeypointConfig(), seed=2)
    network.encoder.load_state_dict(contact.encoder.state_dict())
    record = {"encoder": encoder_record(tmp_path / "contact.safetensors")}
    save_network(network, tmp_path / "head.safetensors", record)
    save_network(network, tmp_path / "whole.safetensors", {})
    return tmp_path / "head.safetensors"


def test_head_and_encoder_together_are_the_whole_network(head: Path) -> None:
    whole = head.with_name("whole.safetensors")
    assert head.stat().st_size < 0.4 * whole.stat().st_size
    for name, value in load_network(whole, KeypointNetwork).state_dict().items():
        found = load_network(head, KeypointNetwork).state_dict()[name]
        np.testing.assert_array_equal(found, value, err_msg=name)
    rng = np.random.default_rng(7)
    scene = make_cloud(rng), np.array([0.1, 0.0]), np.zeros(3), make_hand(rng)
    split, joined = (read_keypoint_model(path).predict(*scene) for path in (head, whole))
    np.testing.assert_array_equal(split, joined)


@pytest.mark.parametrize("read", READERS)
def test_another_encoder_is_refused(head: Path, read: Callable[[Path], Any]) -> None:
    save_network(
        random_network("contact", EncoderConfig(), seed=5),
        head.with_name("contact.safetensors"),
        {},
    )
    with pytest.raises(UserError, match=r"head\.safe.*encoder .*contact\.safetensors has sha256"):
        read(head)


@pytest.mark.parametrize("read", READERS)
def test_a_missing_encoder_is_named(head: Path, read: Callable[[Path], Any]) -> None:
    head.with_name("contact.safetensors").unlink()
    with pytest.raises(UserError, match=r"head\.safe.*encoder .*contact\.safetensors is missing"):
        read(head)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(
    "named",
    [
        "contact",
        {"file": "contact.safetensors"},
        3,
        {"file": "", "sha256": "0"},
        {"file": "/", "sha256": "0"},
    ],
)
def test_a_card_that_names_no_encoder_is_refused(
    head: Path, read: Callable[[Path], Any], named: object
) -> None:
    card = json.loads(head.with_suffix(".json").read_text())
    head.with_suffix(".json").write_text(json.dumps({**card, "encoder": named}))
    with pytest.raises(UserError, match=r"head\.json: encoder is .*; allowed: "):
        read(head)


def test_clips_are_those_of_the_card(tmp_path: Path) -> None:
    path = tmp_path / "bc.safetensors"
    network = random_network("behavior_cloning", KeypointConfig())
    save_network(network, path, {"action_clips": {"translation": 0.02, "rotation": 0.3}})
    assert Clips.read(path) == Clips(0.02, 0.3)
    for wrong in (None, {}, {"translation": 0.1}, {"translation": 0, "rotation": 1},
                  {"translation": 10**400, "rotation": 1}, "much"):  # fmt: skip
        save_network(network, path, {"action_clips": wrong})
        with pytest.raises(UserError, match=r"bc\.json: action_clips is .*; allowed: "):
            Clips.read(path)
