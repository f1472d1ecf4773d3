"""How many episodes succeeded."""

from dataclasses import dataclass

from keypush.evaluation.wilson import wilson_interval
from keypush.reporting.episodes import Episodes


@dataclass(frozen=True)
class Tally:
    """Counts of some episodes, at least one."""

    episodes: int
    successes: int
    settled: int
    """Episodes whose goal still held after the tool had stopped."""

    @property
    def rate(self) -> float:
        """The share of successes."""
        return self.successes / self.episodes

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % Wilson interval of `rate`."""
        return wilson_interval(self.successes, self.episodes)


def tally(episodes: Episodes) -> Tally:
    """Counts episodes."""
    return Tally(
        episodes=len(episodes),
        successes=int(episodes["success"].sum()),
        settled=int(episodes["settled_success"].sum()),
    )
