"""How far a job is: an estimate before it starts, and a bar on a terminal."""

import shutil
import sys
from collections.abc import Mapping
from typing import Self

from tqdm import tqdm

from keypush.rollout.job import Block, Job
from keypush.rollout.shard import Shard
from keypush.rollout.store import EpisodeStore, Finished

SECONDS_PER_EPISODE = 0.9
"""Of one core; see docs/collect.md."""
BYTES_PER_EPISODE = 35_000
"""Of both files; see docs/collect.md."""
_BAR = (
    "{percentage:3.0f}%|{bar}| {n_fmt}/{total_fmt} episodes "
    "[{elapsed}, {remaining} left, {rate_noinv_fmt}{postfix}]"
)


class Progress:
    """Counts episodes, successes and bytes; a block that starts again is counted once."""

    def __init__(self, job: Job, finished: Mapping[Block, Finished]) -> None:
        """Args: the job and its blocks that are finished already."""
        self._total = job.total
        self._done = sum(block.count for block in finished)
        self._successes = sum(block.successes for block in finished.values())
        self._size = sum(block.size for block in finished.values())
        self._under_way: dict[Block, list[bool]] = {}

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

    def announce(self, store: EpisodeStore, workers: int) -> None:
        """Says what is to be expected, from constants or from the blocks that are there."""
        left = self._total - self._done
        seconds = left * SECONDS_PER_EPISODE / min(workers, left)
        name = "1 worker" if workers == 1 else f"{workers} workers"
        free = shutil.disk_usage(store.folder).free
        say(
            f"{left} of {self._total} episodes to run: about {_duration(seconds)} with {name}, "
            f"{_size(left * self._bytes_per_episode())} of {_size(free)} free"
        )

    def episode_done(self, block: Block, success: bool) -> None:
        """Counts an episode of a block under way."""
        self._under_way.setdefault(block, []).append(success)
        self._show(1)

    def block_lost(self, block: Block) -> None:
        """Takes the episodes of a block back, which starts again."""
        self._show(-len(self._under_way.pop(block, [])))

    def block_done(self, block: Block, shard: Shard) -> None:
        """Counts a block, with those of its episodes that were not counted one by one."""
        counted = self._under_way.pop(block, [])
        self._done += block.count
        self._successes += shard.successes
        self._size += shard.size
        self._show(block.count - len(counted))

    def _show(self, more: int) -> None:
        under_way = [success for block in self._under_way.values() for success in block]
        done = self._done + len(under_way)
        rate = (self._successes + sum(under_way)) / max(done, 1)
        expected = _size(self._total * self._bytes_per_episode())
        self._bar.set_postfix_str(
            f"success {rate:.1%}, {_size(self._size)} of about {expected}", refresh=False
        )
        self._bar.update(more)

    def _bytes_per_episode(self) -> float:
        return self._size / self._done if self._done else BYTES_PER_EPISODE


def say(text: str) -> None:
    """Writes a line to stderr, above the bar."""
    tqdm.write(f"keypush: {text}", file=sys.stderr)


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _size(count: float) -> str:
    return f"{count / 1e9:.1f} GB" if count >= 1e9 else f"{count / 1e6:.1f} MB"
