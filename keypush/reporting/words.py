"""How figures are written."""

from collections.abc import Sequence

from keypush.reporting.tally import Tally

MINUS = "\N{MINUS SIGN}"
NOTHING = "\N{EN DASH}"
"""Stands where there is no figure."""


def percent(share: float) -> str:
    """Writes a share as per cent."""
    return f"{100 * share:.1f} %"


def percent_range(ends: tuple[float, float]) -> str:
    """Writes the ends of an interval of shares as per cent."""
    low, high = ends
    return f"{100 * low:.1f} to {100 * high:.1f} %"


def points(difference: float) -> str:
    """Writes a difference of two shares in percentage points, with its sign."""
    value = round(100 * difference, 1)
    return f"{'+' if value > 0 else MINUS if value < 0 else ''}{abs(value):.1f}"


def points_range(ends: tuple[float, float]) -> str:
    """Writes the ends of an interval of differences in percentage points."""
    return " to ".join(points(end) for end in ends)


def p_value(p: float) -> str:
    """Writes a p-value with three digits behind the point."""
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def count(number: int, one: str, many: str) -> str:
    """Writes a number with its noun, in the singular or in the plural."""
    return f"{grouped(number)} {one if number == 1 else many}"


def grouped(number: int) -> str:
    """Writes a number with its thousands apart."""
    return f"{number:,}".replace(",", "\N{NO-BREAK SPACE}")


def listed(words: Sequence[str]) -> str:
    """Joins words as in a sentence."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def success_words(tally: Tally) -> str:
    """Writes successes, trials, rate and interval, as a tooltip tells them."""
    return (
        f"{tally.successes} of {tally.episodes}, {percent(tally.rate)} "
        f"({percent_range(tally.interval)})"
    )
