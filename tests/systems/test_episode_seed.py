"""Seed and episode in a context, and the policy step of a time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.systems.framework import BasicVector, LeafSystem

from keypush.seeding import make_generator
from keypush.systems.episode_seed import (
    declare_episode_seed,
    episode_generator,
    policy_step,
    set_episode_seed,
)


class Seeded(LeafSystem):
    def __init__(self) -> None:
        super().__init__()
        declare_episode_seed(self)


@given(st.integers(0, 2**53), st.integers(0, 2**53))
def test_the_context_carries_every_seed_and_episode_exactly(seed: int, episode: int) -> None:
    context = Seeded().CreateDefaultContext()
    set_episode_seed(context, seed, episode)
    drawn = episode_generator(context, "torque", 7).bytes(8)
    assert drawn == make_generator(seed, episode, "torque", 7).bytes(8)


def test_the_parameter_must_be_the_first() -> None:
    class Late(LeafSystem):
        def __init__(self) -> None:
            super().__init__()
            self.set_name("late")
            self.DeclareNumericParameter(BasicVector(1))
            declare_episode_seed(self)

    with pytest.raises(RuntimeError, match="late: seed parameter has index 1"):
        Late()


@given(
    st.integers(0, 100_000),
    st.sampled_from([0.1, 0.01, 0.03, 0.05, 1.0, 1 / 3]),
    st.floats(0.0, 0.9999),
)
def test_a_policy_step_begins_at_its_multiple_of_the_period(
    step: int, period: float, share: float
) -> None:
    context = Seeded().CreateDefaultContext()
    times = {step * period, (step + share) * period, float(np.nextafter(step * period, 0.0))}
    for time in times:
        context.SetTime(time)
        assert policy_step(context, period) == step
