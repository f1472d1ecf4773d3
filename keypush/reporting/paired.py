"""Statistics of two policies that drove in the same episodes.

Of n such pairs, b are those in which only the first policy succeeded, c those in which only the
second did. The others say nothing of the difference.
"""

import math
from collections.abc import Sequence

from scipy.optimize import brentq
from scipy.stats import binomtest

from keypush.evaluation.wilson import Z_95

_ABOVE = 1e-9


def mcnemar_p(b: int, c: int) -> float:
    """Returns the two-sided p-value of McNemar's exact test.

    Were both policies equally good, each of the b + c pairs that differ would fall to either
    with probability 1/2.

    Source: Q. McNemar, "Note on the sampling error of the difference between correlated
    proportions or percentages", Psychometrika 12 (1947), p. 153, with the binomial distribution
    in place of its approximation.
    """
    return float(binomtest(b, b + c, 0.5).pvalue) if b + c else 1.0


def tango_interval(b: int, c: int, n: int, z: float = Z_95) -> tuple[float, float]:
    """Returns the interval of the difference of two paired success rates, 95 % by default.

    It holds the differences that the score test does not refuse, stays inside [-1, 1] and is right
    for few pairs and for b = c = 0.

    Args:
        b: pairs in which only the first succeeded.
        c: pairs in which only the second succeeded.
        n: all pairs, at least one.
        z: quantile of the normal distribution that sets the confidence.

    Raises:
        ValueError: the counts are impossible.

    Source: T. Tango, "Equivalence test and confidence interval for the difference in proportions
    for the paired-sample design", Stat. Med. 17 (1998), p. 891.
    """
    if min(b, c) < 0 or n < 1 or b + c > n:
        raise ValueError(f"b, c, n are {b}, {c}, {n}; allowed: 0 <= b, 0 <= c, 1 <= n, b + c <= n")
    return -_upper_end(c, b, n, z), _upper_end(b, c, n, z)


def _upper_end(b: int, c: int, n: int, z: float) -> float:
    """The largest difference d whose score, (n d - (b - c)) / deviation(d), is at most z."""
    if b == n:
        return 1.0

    def excess(d: float) -> float:
        # Multiplied by the deviation, so that the ends of the range need no division by zero.
        return n * d - (b - c) - z * math.sqrt(n * _variance(d, b, c, n))

    # Where no pair differs, or all do, the observed difference itself is a root, but not the end.
    return float(brentq(excess, (b - c) / n + _ABOVE, 1.0, xtol=1e-12))


def _variance(d: float, b: int, c: int, n: int) -> float:
    """Variance of one pair's difference where the true one is d, Tango's equation 12.

    2 q + d (1 - d), with q the most likely probability that only the second succeeds, given d.
    """
    linear = -b - c + (2 * n - b + c) * d
    constant = -c * d * (1 - d)
    root = math.sqrt(max(linear**2 - 8 * n * constant, 0.0))
    q = (root - linear) / (4 * n)
    return max(2 * q + d * (1 - d), 0.0)


def holm(p_values: Sequence[float]) -> list[float]:
    """Returns p-values adjusted for their number; all below 5 % holds at 5 % for all of them.

    Source: S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Stat. 6
    (1979), p. 65.
    """
    adjusted = [0.0] * len(p_values)
    largest = 0.0
    for rank, index in enumerate(sorted(range(len(p_values)), key=lambda i: p_values[i])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        adjusted[index] = largest
    return adjusted
