"""The reward: success alone, and a potential that leaves the best policy the best."""

import numpy as np
import pytest

from keypush.environments.reward import ENDS, Reward
from keypush.systems.episode_monitor import Outcome

LENGTH = 0.64


def test_without_shaping_only_success_pays() -> None:
    reward = Reward(shaping=0.0, discount=0.99, length=LENGTH)
    for outcome in Outcome:
        assert reward(0.3, 0.2, outcome) == float(outcome == Outcome.SUCCESS)


def test_coming_nearer_pays_and_going_away_costs() -> None:
    reward = Reward(shaping=0.5, discount=1.0, length=LENGTH)
    nearer = reward(0.3, 0.2, Outcome.RUNNING)
    assert nearer == pytest.approx(0.5 * 0.1 / LENGTH)
    assert reward(0.2, 0.3, Outcome.RUNNING) == pytest.approx(-nearer)


@pytest.mark.parametrize("end", ENDS)
def test_over_an_episode_the_potential_adds_a_constant(end: Outcome) -> None:
    """Whatever was done in between, and however it ended."""
    discount = 0.95
    shaped = Reward(shaping=2.0, discount=discount, length=LENGTH)
    plain = Reward(shaping=0.0, discount=discount, length=LENGTH)
    start = 0.31
    for seed in range(3):
        path = [start, *np.random.default_rng(seed).uniform(0.0, 0.6, size=5 + seed)]
        outcomes = [Outcome.RUNNING] * (len(path) - 2) + [end]
        sums = [
            sum(
                discount**k * reward(before, after, outcome)
                for k, (before, after, outcome) in enumerate(
                    zip(path[:-1], path[1:], outcomes, strict=True)
                )
            )
            for reward in (shaped, plain)
        ]
        assert sums[0] - sums[1] == pytest.approx(-2.0 * (1 - start / LENGTH))


def test_a_time_out_keeps_the_potential() -> None:
    reward = Reward(shaping=1.0, discount=0.9, length=LENGTH)
    assert reward(0.3, 0.2, Outcome.TIMED_OUT) == reward(0.3, 0.2, Outcome.RUNNING)
