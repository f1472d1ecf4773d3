from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from keypush.errors import UserError
from keypush.learning.checkpoint import save_network
from keypush.learning.goal_frame import GoalFrame
from keypush.learning.hand import hand_state
from keypush.learning.patches import group_patches_batch
from keypush.learning.predict import (
    CentroidKeypoint,
    KeypointModel,
    NetworkKeypoint,
    load_keypoint_model,
)
from keypush.networks.config import EncoderConfig, SurfaceConfig
from keypush.networks.contact_network import ContactNetwork
from keypush.networks.surface_keypoint_network import NetworkInput
from tests.learning.scenes import SMALL, make_cloud, make_hand, make_network

SEEDS = st.integers(0, 2**32 - 1)
WITH_COM = SurfaceConfig(
    patches=4, patch_size=8, width=16, patch_width=16, heads=2, query_heads=2, use_com=True
)
MODELS: list[KeypointModel] = [
    CentroidKeypoint(),
    NetworkKeypoint(make_network(SMALL)),
    NetworkKeypoint(make_network(WITH_COM)),
]


@pytest.mark.parametrize("model", MODELS)
@given(SEEDS)
def test_keypoint_moves_with_the_scene(model: KeypointModel, seed: int) -> None:
    rng = np.random.default_rng(seed)
    cloud, hand = make_cloud(rng), make_hand(rng)
    goal, com = np.array([0.2, 0.1]), cloud.mean(axis=0) + np.array([0.01, 0.005, 0.0])
    p_WK = model.predict(cloud, goal, com, hand)
    angle, shift = rng.uniform(-np.pi, np.pi), np.array([*rng.uniform(-0.2, 0.2, 2), 0.0])
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned_goal = R[:2, :2] @ goal + shift[:2]
    turned_hand = np.concatenate([R @ hand[:3] + shift, R @ hand[3:6], R @ hand[6:9]])
    turned = model.predict(cloud @ R.T + shift, turned_goal, R @ com + shift, turned_hand)
    np.testing.assert_allclose(turned, R @ p_WK + shift, atol=1e-4)


@pytest.mark.parametrize("model", MODELS)
def test_order_of_the_points_does_not_matter(model: KeypointModel) -> None:
    rng = np.random.default_rng(3)
    cloud, hand = make_cloud(rng), make_hand(rng)
    goal, com = np.array([0.2, 0.1]), cloud.mean(axis=0)
    p_WK = model.predict(cloud, goal, com, hand)
    shuffled = model.predict(rng.permutation(cloud), goal, com, hand)
    np.testing.assert_allclose(shuffled, p_WK, atol=1e-4)


@pytest.mark.parametrize(
    "config", [SMALL, WITH_COM, SurfaceConfig(), SurfaceConfig(use_hand=False)]
)
def test_numpy_forward_agrees_with_torch(config: SurfaceConfig) -> None:
    rng = np.random.default_rng(4)
    network = make_network(config)
    # Norm layers start as the identity, which would hide a wrong gain or bias.
    with torch.no_grad(), torch.random.fork_rng():
        torch.manual_seed(1)
        for parameter in network.parameters():
            parameter.add_(0.1 * torch.randn_like(parameter))
    cloud, hand = make_cloud(rng, 512), make_hand(rng)
    goal, com = np.array([0.2, 0.1]), cloud.mean(axis=0) + np.array([0.01, 0.0, 0.0])
    frame = GoalFrame.of(com if config.use_com else cloud.mean(axis=0), goal)
    points = torch.tensor(frame.to_goal(cloud))[None]
    centres, members = group_patches_batch(points, config.patches, config.patch_size)
    scene = NetworkInput(
        cloud=points,
        centres=centres,
        members=members,
        goal=torch.tensor(frame.to_goal(np.array([*goal, 0.0])))[None, :2],
        com=torch.tensor(frame.to_goal(com))[None],
        hand=torch.tensor(frame.hand_to_goal(hand))[None],
    )
    with torch.inference_mode():
        expected = frame.to_world(network(scene)[0].numpy())
    p_WK = NetworkKeypoint(network).predict(cloud, goal, com, hand)
    np.testing.assert_allclose(p_WK, expected, atol=1e-5)


def test_keypoint_lies_within_the_cloud() -> None:
    rng = np.random.default_rng(5)
    cloud = make_cloud(rng)
    p_WK = MODELS[1].predict(cloud, np.array([0.1, 0.0]), None, make_hand(rng))
    assert (p_WK >= cloud.min(axis=0)).all()
    assert (p_WK <= cloud.max(axis=0)).all()


def test_non_finite_input_gives_a_non_finite_keypoint() -> None:
    rng = np.random.default_rng(6)
    cloud = make_cloud(rng)
    cloud[7, 1] = np.nan
    p_WK = MODELS[1].predict(cloud, np.array([0.1, 0.0]), None, make_hand(rng))
    assert p_WK.shape == (3,)
    assert not np.isfinite(p_WK).any()


def test_saved_network_predicts_the_same_bits(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    scene = make_cloud(rng), np.array([0.1, 0.0]), None, make_hand(rng)
    path = tmp_path / "some.safetensors"
    save_network(make_network(SMALL), path, {"seed": 3})
    loaded = load_keypoint_model(path)
    np.testing.assert_array_equal(loaded.predict(*scene), MODELS[1].predict(*scene))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["some.json", "some.safetensors"]


def test_bad_weights_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no_such_weights.*allowed"):
        load_keypoint_model("no_such_weights")
    path = tmp_path / "some.safetensors"
    save_network(make_network(SMALL), path, {})
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(UserError, match=r"some\.safetensors: cannot be loaded"):
        load_keypoint_model(path)
    save_network(make_network(SMALL), path, {})
    description = path.with_suffix(".json")
    for text, told in [
        ("{", "no JSON"),
        ("[]", "found list; allowed: an object"),
        ("{}", "kind is ''; allowed: contact, keypoint, behavior_cloning, surface_keypoint"),
        ('{"kind": "surface_keypoint"}', "expected the sizes of the network under 'network'"),
        (
            '{"kind": "surface_keypoint", "network": {"no_such_size": 1}}',
            "expected the sizes of the network under 'network'",
        ),
    ]:
        description.write_text(text)
        with pytest.raises(UserError, match=rf"some\.json: {told}"):
            load_keypoint_model(path)
    save_network(ContactNetwork(EncoderConfig()), path, {})
    with pytest.raises(UserError, match=r"kind is 'contact'; allowed here: surface_keypoint"):
        load_keypoint_model(path)
    description.unlink()
    with pytest.raises(UserError, match=r"some\.json: cannot be read"):
        load_keypoint_model(path)


def test_weights_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    path, other = tmp_path / "some.safetensors", tmp_path / "other.safetensors"
    save_network(make_network(SMALL), path, {})
    save_network(make_network(WITH_COM), other, {})
    path.write_bytes(other.read_bytes())
    with pytest.raises(UserError, match=r"cannot be loaded.*query"):
        load_keypoint_model(path)


def test_missing_com_and_small_cloud_are_refused() -> None:
    rng = np.random.default_rng(8)
    goal, hand = np.array([0.1, 0.0]), make_hand(rng)
    with pytest.raises(UserError, match=r"predictor\.use_com"):
        MODELS[2].predict(make_cloud(rng), goal, None, hand)
    with pytest.raises(UserError, match=r"noise\.cloud_points is 7"):
        MODELS[1].predict(make_cloud(rng, 7), goal, None, hand)


def test_hand_state_is_position_and_two_columns() -> None:
    X_WE = np.arange(12.0).reshape(3, 4)
    expected = [*X_WE[:, 3], *X_WE[:, 0], *X_WE[:, 1]]
    np.testing.assert_array_equal(hand_state(X_WE), expected)
