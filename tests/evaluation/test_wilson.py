"""Wilson's interval against published and closed-form values."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest

from keypush.evaluation.wilson import Z_95, wilson_interval


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [
        # Newcombe, "Two-sided confidence intervals for the single proportion", Stat. Med. 17
        # (1998), table I, method 3.
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_published_values(successes: int, trials: int, low: float, high: float) -> None:
    assert wilson_interval(successes, trials) == pytest.approx((low, high), abs=5e-5)


counts = st.integers(1, 5000).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n)))


@given(counts)
def test_agrees_with_scipy(case: tuple[int, int]) -> None:
    successes, trials = case
    theirs = binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    assert wilson_interval(successes, trials) == pytest.approx((theirs.low, theirs.high), abs=1e-9)


@given(counts)
def test_ends_solve_the_score_equation(case: tuple[int, int]) -> None:
    """At both ends p, |rate - p| is z standard deviations of a rate whose mean is p."""
    successes, trials = case
    rate = successes / trials
    for p in wilson_interval(successes, trials):
        assert abs(rate - p) == pytest.approx(Z_95 * math.sqrt(p * (1 - p) / trials), abs=1e-9)


def test_no_trials_say_nothing() -> None:
    assert wilson_interval(0, 0) == (0.0, 1.0)


@pytest.mark.parametrize("successes", [-1, 6])
def test_impossible_counts_are_refused(successes: int) -> None:
    with pytest.raises(ValueError, match="allowed: 0 to 5"):
        wilson_interval(successes, 5)
