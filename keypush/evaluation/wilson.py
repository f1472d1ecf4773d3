"""Wilson's score interval of a success rate."""

import math

Z_95 = 1.959963984540054
"""The 97.5 % quantile of the normal distribution."""


def wilson_interval(successes: int, trials: int, z: float = Z_95) -> tuple[float, float]:
    """Returns the interval that holds a success rate, by default with 95 % confidence.

    Unlike the normal approximation it stays inside [0, 1] and is right for few trials and
    for rates near 0 and 1. Without trials it is (0, 1): nothing is known.

    Args:
        successes: 0 <= successes <= trials.
        trials: number of independent trials.
        z: quantile of the normal distribution that sets the confidence.

    Raises:
        ValueError: successes lies outside 0 to trials.

    Source: E. B. Wilson, "Probable inference, the law of succession, and statistical
    inference", J. Am. Stat. Assoc. 22 (1927), p. 209.
    """
    if not 0 <= successes <= trials:
        raise ValueError(f"successes is {successes}; allowed: 0 to {trials}")
    if trials == 0:
        return 0.0, 1.0
    rate, z2 = successes / trials, z * z
    centre = (rate + z2 / (2 * trials)) / (1 + z2 / trials)
    half = z / (1 + z2 / trials) * math.sqrt(rate * (1 - rate) / trials + (z / (2 * trials)) ** 2)
    low = 0.0 if successes == 0 else centre - half
    high = 1.0 if successes == trials else centre + half
    return low, high
