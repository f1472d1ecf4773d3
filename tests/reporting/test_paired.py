"""Paired statistics against published values, closed formulas and brute force."""

import math
from itertools import combinations, product

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar
from scipy.stats import norm

from keypush.evaluation.wilson import Z_95
from keypush.reporting.paired import holm, mcnemar_p, tango_interval

counts = st.integers(1, 300).flatmap(
    lambda n: st.integers(0, n).flatmap(
        lambda b: st.tuples(st.just(b), st.integers(0, n - b), st.just(n))
    )
)


@pytest.mark.parametrize(("b", "c"), [(0, 0), (1, 0), (2, 10), (5, 5), (7, 1)])
def test_mcnemar_counts_the_ways_to_be_as_uneven(b: int, c: int) -> None:
    """Every way in which the pairs that differ could have fallen is as likely as any other."""
    falls = [sum(way) for way in product((0, 1), repeat=b + c)]
    as_uneven = [abs(2 * fall - b - c) >= abs(b - c) for fall in falls]
    assert mcnemar_p(b, c) == pytest.approx(sum(as_uneven) / len(falls), abs=1e-12)


@pytest.mark.parametrize(
    ("b", "c", "n", "confidence", "low", "high"),
    [
        # Fagerland, Lydersen and Laake, "Recommended tests and confidence intervals for paired
        # binomial proportions", Stat. Med. 33 (2014), p. 2850: the airways of 21 children before
        # and after a transplantation.
        (1, 7, 21, 0.95, -0.517, -0.026),
        # R's PropCIs, scoreci.mp(25, 28, 618, 0.90), which subtracts the other way round.
        (28, 25, 618, 0.90, -0.0148, 0.0247),
    ],
)
def test_published_intervals(
    b: int, c: int, n: int, confidence: float, low: float, high: float
) -> None:
    z = float(norm.ppf((1 + confidence) / 2))
    assert tango_interval(b, c, n, z) == pytest.approx((low, high), abs=5e-4)


@given(counts)
def test_ends_have_the_score_of_the_quantile(case: tuple[int, int, int]) -> None:
    """The observed difference is z deviations from an end, under the likeliest way to reach it."""
    b, c, n = case
    for end in tango_interval(b, c, n):
        if abs(end) > 1 - 1e-6:
            continue
        variance = _likeliest_variance(end, b, c, n)
        score = abs((b - c) / n - end) / math.sqrt(variance / n)
        assert score == pytest.approx(Z_95, abs=2e-3)


def _likeliest_variance(d: float, b: int, c: int, n: int) -> float:
    """Of one pair's difference, where P(only first) - P(only second) = d; by search."""

    def unlikely(q: float) -> float:
        cells = ((b, q + d), (c, q), (n - b - c, 1 - 2 * q - d))
        return -sum(count * math.log(max(p, 1e-300)) for count, p in cells if count)

    low, high = max(0.0, -d), (1 - d) / 2
    q = minimize_scalar(unlikely, bounds=(low, high), method="bounded", options={"xatol": 1e-12}).x
    return float(2 * q + d - d * d)


@given(counts)
def test_interval_holds_the_observed_difference_and_turns_with_the_policies(
    case: tuple[int, int, int],
) -> None:
    b, c, n = case
    low, high = tango_interval(b, c, n)
    assert -1 <= low <= (b - c) / n <= high <= 1
    assert tango_interval(c, b, n) == pytest.approx((-high, -low), abs=1e-9)


@given(counts)
def test_interval_leaves_zero_out_where_mcnemars_score_does(case: tuple[int, int, int]) -> None:
    """At difference 0 Tango's score is McNemar's, (b - c) / sqrt(b + c)."""
    b, c, n = case
    score = abs(b - c) / math.sqrt(b + c) if b + c else 0.0
    low, high = tango_interval(b, c, n)
    assert (low > 0 or high < 0) == (score > Z_95)


@pytest.mark.parametrize("n", [1, 20, 1600])
def test_without_differing_pairs_the_ends_have_a_closed_form(n: int) -> None:
    end = Z_95**2 / (n + Z_95**2)
    assert tango_interval(0, 0, n) == pytest.approx((-end, end), abs=1e-9)


@pytest.mark.parametrize(("b", "c", "n"), [(-1, 0, 5), (0, 0, 0), (3, 3, 5)])
def test_impossible_counts_are_refused(b: int, c: int, n: int) -> None:
    with pytest.raises(ValueError, match="allowed"):
        tango_interval(b, c, n)


@given(st.lists(st.floats(0, 1), max_size=7))
def test_holm_is_closed_testing_with_bonferroni(p_values: list[float]) -> None:
    """A hypothesis falls where every group that it is in falls by Bonferroni's test."""
    indices = range(len(p_values))
    groups = [g for size in indices for g in combinations(indices, size + 1)]
    adjusted = [
        max(min(1.0, len(g) * min(p_values[i] for i in g)) for g in groups if index in g)
        for index in indices
    ]
    assert holm(p_values) == pytest.approx(adjusted)
