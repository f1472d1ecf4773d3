"""Every random draw comes from a generator seeded by (scenario seed, episode, purpose)."""

import zlib

import numpy as np

EVALUATION_SEEDS = 1_000_000
"""Scenario seeds from here on are for evaluation; data sets have those below."""


def evaluation_seed(seed: int) -> int:
    """Returns the scenario seed of an evaluation, which no data set has.

    Args:
        seed: number n below `EVALUATION_SEEDS`, for the n-th seed of evaluation, or that itself.
    """
    return seed if seed >= EVALUATION_SEEDS else EVALUATION_SEEDS + seed


def make_generator(seed: int, episode: int, purpose: str, step: int = 0) -> np.random.Generator:
    """Makes the generator of one purpose in one episode.

    The stream depends on its arguments alone, never on what was drawn before it or
    on the process that draws, so results are the same for any number of processes.

    Args:
        seed: scenario seed, >= 0.
        episode: episode index, >= 0.
        purpose: what the numbers are for, such as "goal" or "point_cloud_noise".
        step: policy step, for draws that repeat within an episode.
    """
    return np.random.default_rng([seed, episode, zlib.crc32(purpose.encode()), step])
