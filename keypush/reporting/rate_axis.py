"""The axis of success rates."""

import math
from collections.abc import Iterable

from keypush.reporting.tally import Tally


class RateAxis:
    """From a round rate below all intervals, and not above 80 %, to 100 %."""

    def __init__(self, tallies: Iterable[Tally], start: float, end: float) -> None:
        """Makes an axis.

        Args:
            tallies: what will be drawn.
            start: pixel of the lowest rate.
            end: pixel of 100 %.
        """
        lowest = min((counted.interval[0] for counted in tallies), default=0.0)
        self.low = min(math.floor(10 * lowest) / 10, 0.8)
        self._start, self._end = start, end

    def at(self, rate: float) -> float:
        """Returns the pixel of a rate."""
        return self._start + (rate - self.low) / (1 - self.low) * (self._end - self._start)

    def ticks(self) -> list[float]:
        """Returns rates to be labelled: steps of 5, 10 or 20 %."""
        step = 0.05 if self.low >= 0.8 else 0.1 if self.low >= 0.5 else 0.2
        count = math.floor((1 - self.low) / step + 1e-9)
        return [1 - step * i for i in reversed(range(count + 1))]
