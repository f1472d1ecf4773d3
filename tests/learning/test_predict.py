import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from keypush.errors import UserError
from keypush.learning.baselines import CentroidKeypoint, GeometricKeypoint
from keypush.learning.eager import both_models, random_network
from keypush.learning.hand import hand_state
from keypush.learning.model import KeypointModel
from keypush.networks.config import KeypointConfig, SurfaceConfig
from keypush.planning.push_frame import left_of, push_direction
from tests.learning.scenes import SMALL, make_cloud, make_hand, make_network

SEEDS = st.integers(0, 2**32 - 1)
WITH_COM = SurfaceConfig(
    patches=4, patch_size=8, width=16, patch_width=16, heads=2, query_heads=2, use_com=True
)
SURFACE, SURFACE_COM = (
    both_models("surface_keypoint", make_network(config))[0] for config in (SMALL, WITH_COM)
)
THESIS = both_models("keypoint", random_network("keypoint", KeypointConfig()))[0]
MODELS: list[KeypointModel] = [
    CentroidKeypoint(),
    GeometricKeypoint(uses_com=False),
    GeometricKeypoint(uses_com=True),
    SURFACE,
    SURFACE_COM,
]
"""All that see a scene in a frame that moves with it: the thesis' networks do not."""


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


@pytest.mark.parametrize("model", [*MODELS, THESIS])
def test_order_of_the_points_does_not_matter(model: KeypointModel) -> None:
    rng = np.random.default_rng(3)
    cloud, hand = make_cloud(rng), make_hand(rng)
    goal, com = np.array([0.2, 0.1]), cloud.mean(axis=0)
    p_WK = model.predict(cloud, goal, com, hand)
    shuffled = model.predict(rng.permutation(cloud), goal, com, hand)
    np.testing.assert_allclose(shuffled, p_WK, atol=1e-4)


def test_keypoint_lies_within_the_cloud() -> None:
    rng = np.random.default_rng(5)
    cloud = make_cloud(rng)
    p_WK = SURFACE.predict(cloud, np.array([0.1, 0.0]), None, make_hand(rng))
    assert (p_WK >= cloud.min(axis=0)).all()
    assert (p_WK <= cloud.max(axis=0)).all()


@pytest.mark.parametrize("uses_com", [True, False])
def test_the_geometric_contact_lies_on_the_outline_behind_the_centre(uses_com: bool) -> None:
    """A noisy cylinder of radius 4 cm, whose centre of mass is 1 cm beside its axis."""
    rng = np.random.default_rng(0)
    angle, axis, radius = rng.uniform(-np.pi, np.pi, 4000), np.array([0.05, -0.02]), 0.04
    wall = axis + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    cloud = np.column_stack([wall, rng.uniform(0.0, 0.1, 4000)])
    cloud += rng.normal(scale=0.001, size=cloud.shape)
    com, goal = np.array([0.05, -0.01, 0.05]), np.array([-0.15, 0.1])
    p_WK = GeometricKeypoint(uses_com=uses_com).predict(cloud, goal, com, np.zeros(9))
    centre = com if uses_com else cloud.mean(axis=0)
    d_W = push_direction(centre, goal)
    assert abs((p_WK - centre) @ left_of(d_W)) < 1e-9
    np.testing.assert_allclose(push_direction(p_WK, goal), d_W, atol=1e-9)
    assert (p_WK - centre) @ d_W < 0
    assert np.hypot(*(p_WK[:2] - axis)) == pytest.approx(radius, abs=0.005)


def test_missing_com_and_small_cloud_are_refused() -> None:
    rng = np.random.default_rng(8)
    goal, hand = np.array([0.1, 0.0]), make_hand(rng)
    for model in (SURFACE_COM, THESIS, GeometricKeypoint(uses_com=True)):
        assert model.uses_com
        with pytest.raises(RuntimeError, match=r"object_com has no value"):
            model.predict(make_cloud(rng), goal, None, hand)
    with pytest.raises(UserError, match=r"noise\.cloud_points is 7; allowed: at least 8 "):
        SURFACE.predict(make_cloud(rng, 7), goal, None, hand)
    with pytest.raises(UserError, match=r"noise\.cloud_points is 31; allowed: at least 32 "):
        THESIS.predict(make_cloud(rng, 31), goal, np.zeros(3), hand)


def test_hand_state_is_position_and_two_columns() -> None:
    X_WE = np.arange(12.0).reshape(3, 4)
    expected = [*X_WE[:, 3], *X_WE[:, 0], *X_WE[:, 1]]
    np.testing.assert_array_equal(hand_state(X_WE), expected)
