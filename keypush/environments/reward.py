"""The reward: one for success, and a potential on the way there if wanted."""

import math
from dataclasses import dataclass
from numbers import Real

from keypush.errors import UserError
from keypush.systems.episode_monitor import Outcome

ENDS = (Outcome.SUCCESS, Outcome.TOPPLED, Outcome.FELL)
"""Outcomes after which nothing more can be earned; a time-out only cuts an episode short."""


@dataclass(frozen=True)
class Reward:
    """r = [success] + discount P(s') - P(s), with P = shaping (1 - distance / length).

    P is 0 where an episode has ended, whichever way. Over an episode the discounted sum of
    such differences is then -P at its start, whatever was done in between, so that the same
    policies are optimal with and without shaping (Ng, Harada and Russell 1999), as long as the
    learner discounts by the same factor and takes a time-out for what it is, a cut.
    """

    shaping: float
    """Potential at the goal; 0 leaves the success alone."""
    discount: float
    """The learner's discount factor."""
    length: float
    """Distance at which the potential is 0, m."""

    def __post_init__(self) -> None:
        """Checks the numbers that a user gave."""
        if not (_is_number(self.shaping) and math.isfinite(self.shaping) and self.shaping >= 0):
            raise UserError(f"shaping is {self.shaping!r}; allowed: a number from 0")
        if not (_is_number(self.discount) and 0 < self.discount <= 1):
            raise UserError(f"discount is {self.discount!r}; allowed: a number above 0, up to 1")

    def __call__(self, before: float, after: float, outcome: Outcome) -> float:
        """Returns the reward of one policy step.

        Args:
            before: distance of object and goal in xy when the action was chosen, m.
            after: the same when the step was over, m.
            outcome: then.
        """
        kept = 0.0 if outcome in ENDS else self.discount * self._potential(after)
        return float(outcome == Outcome.SUCCESS) + kept - self._potential(before)

    def _potential(self, distance: float) -> float:
        return self.shaping * (1.0 - distance / self.length)


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
