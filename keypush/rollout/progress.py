"""How far a job is: an estimate before it starts, and a bar on a terminal."""

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Self

from tqdm import tqdm

from keypush.rollout.shard import Shard
from keypush.rollout.store import Found

SECONDS_PER_EPISODE = 0.65
"""Of one core; see docs/collect.md."""
BYTES_PER_EPISODE = 35_000
"""Of both files; see docs/collect.md."""
_BAR = (
    "{percentage:3.0f}%|{bar}| {n_fmt}/{total_fmt} episodes "
    "[{elapsed}, {remaining} left, {rate_noinv_fmt}{postfix}]"
)


class Progress:
    """Counts episodes, successes and bytes."""

    def __init__(self, total: int, found: Sequence[Found]) -> None:
        """Args: how many episodes there are, and what is there already."""
        self._total = total
        self._done = sum(folder.episodes for folder in found)
        self._successes = sum(folder.successes for folder in found)
        self._size = sum(folder.size for folder in found)

    def __enter__(self) -> Self:
        """Shows the bar, if there is a terminal."""
        self._bar = tqdm(
            total=self._total, initial=self._done, unit="episodes", bar_format=_BAR, disable=None,
            smoothing=0.02,  # Of workers that report in turn, only the mean says anything.
        )  # fmt: skip
        return self

    def __exit__(self, *error: object) -> None:
        """Leaves the bar on the screen as it is."""
        self._bar.close()

    def announce(self, folder: Path, workers: int) -> None:
        """Says what is to be expected, from constants or from the episodes that are there.

        Args:
            folder: on the disk that is to hold the files.
            workers: how many blocks run at once.
        """
        left = self._total - self._done
        seconds = left * SECONDS_PER_EPISODE / min(workers, left)
        name = "1 worker" if workers == 1 else f"{workers} workers"
        free = shutil.disk_usage(folder).free
        say(
            f"{left} of {self._total} episodes to run: about {duration(seconds)} with {name}, "
            f"{_size(left * self._bytes_per_episode())} of {_size(free)} free"
        )

    def episode_done(self, shard: Shard) -> None:
        """Counts an episode."""
        self._done += 1
        self._successes += shard.successes
        self._size += shard.size
        expected = _size(self._total * self._bytes_per_episode())
        self._bar.set_postfix_str(
            f"success {self._successes / self._done:.1%}, {_size(self._size)} of about {expected}",
            refresh=False,
        )
        self._bar.update(1)

    def _bytes_per_episode(self) -> float:
        return self._size / self._done if self._done else BYTES_PER_EPISODE


def say(text: str) -> None:
    """Writes a line to stderr, above the bar."""
    tqdm.write(f"keypush: {text}", file=sys.stderr)


def duration(seconds: float) -> str:
    """Says a time in the unit that suits it."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _size(count: float) -> str:
    return f"{count / 1e9:.1f} GB" if count >= 1e9 else f"{count / 1e6:.1f} MB"
