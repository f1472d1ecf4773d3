import numpy as np
import torch
from hypothesis import given
from hypothesis import strategies as st

from keypush.learning.goal_frame import GoalFrames
from keypush.learning.inference.goal_frame import LENGTH, GoalFrame
from tests.learning.scenes import make_hand

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_frame_is_proper_and_points_to_the_goal(seed: int) -> None:
    rng = np.random.default_rng(seed)
    centre, goal = rng.uniform(-0.2, 0.2, 3), rng.uniform(-0.2, 0.2, 2)
    frame = GoalFrame.of(centre, goal)
    np.testing.assert_allclose(frame.R_WG @ frame.R_WG.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame.R_WG) > 0.999
    expected = [np.linalg.norm(goal - centre[:2]) / LENGTH, 0.0, 0.0]
    np.testing.assert_allclose(frame.to_goal(np.array([*goal, 0.0])), expected, atol=1e-5)
    points = rng.normal(size=(7, 3))
    np.testing.assert_allclose(frame.to_world(frame.to_goal(points)), points, atol=1e-6)


def test_goal_at_the_centre_gives_a_finite_frame() -> None:
    frame = GoalFrame.of(np.array([0.1, 0.2, 0.0]), np.array([0.1, 0.2]))
    np.testing.assert_array_equal(frame.R_WG, np.eye(3))
    frames = GoalFrames.of(torch.tensor([[0.1, 0.2]]), torch.tensor([[0.1, 0.2]]))
    np.testing.assert_array_equal(frames.R_WG[0], np.eye(3))


@given(SEEDS)
def test_batch_agrees_with_single_scenes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    centres, goals = rng.uniform(-0.2, 0.2, (5, 3)), rng.uniform(-0.2, 0.2, (5, 2))
    points = rng.uniform(-0.2, 0.2, (5, 11, 3))
    hands = np.stack([make_hand(rng) for _ in range(5)])
    frames = GoalFrames.of(torch.tensor(centres), torch.tensor(goals))
    points_G, hands_G = (
        frames.to_goal(torch.tensor(points)),
        frames.hands_to_goal(torch.tensor(hands)),
    )
    for i in range(5):
        frame = GoalFrame.of(centres[i], goals[i])
        np.testing.assert_allclose(points_G[i], frame.to_goal(points[i]), atol=1e-5)
        np.testing.assert_allclose(hands_G[i], frame.hand_to_goal(hands[i]), atol=1e-5)


def test_hand_axes_turn_like_vectors() -> None:
    rng = np.random.default_rng(1)
    hand = make_hand(rng)
    frame = GoalFrame.of(np.zeros(3), np.array([0.1, 0.1]))
    R_GE = frame.R_WG.T @ np.column_stack([hand[3:6], hand[6:9]])
    np.testing.assert_allclose(frame.hand_to_goal(hand)[3:], R_GE.T.ravel(), atol=1e-6)
