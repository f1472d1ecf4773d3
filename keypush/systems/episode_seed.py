"""Seed and episode as a numeric parameter, for the systems that draw random numbers."""

import numpy as np
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from keypush.seeding import make_generator

SEED_PARAMETER = 0


def declare_episode_seed(system: LeafSystem) -> None:
    """Declares the parameter [seed, episode]; must be the system's first parameter."""
    index = system.DeclareNumericParameter(BasicVector(np.zeros(2)))
    if index != SEED_PARAMETER:
        raise RuntimeError(f"{system.get_name()}: seed parameter has index {index}")


def set_episode_seed(context: Context, seed: int, episode: int) -> None:
    """Sets the parameter in a system's context."""
    context.get_mutable_numeric_parameter(SEED_PARAMETER).SetFromVector(
        np.array([seed, episode], dtype=float)
    )


def episode_of(context: Context) -> tuple[int, int]:
    """Returns seed and episode of a system's context."""
    seed, episode = context.get_numeric_parameter(SEED_PARAMETER).value()
    return int(seed), int(episode)


def episode_generator(context: Context, purpose: str, step: int) -> np.random.Generator:
    """Makes the generator of one purpose and policy step in the context's episode."""
    return make_generator(*episode_of(context), purpose, step)


def policy_step(context: Context, period: float) -> int:
    """Returns the index of the policy step that the context's time lies in."""
    return int(np.floor(context.get_time() / period + 1e-6))
