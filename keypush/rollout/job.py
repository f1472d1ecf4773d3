"""A job: the same scenario for several objects and many episodes, cut into blocks."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from keypush.scenario import Scenario

EPISODES_PER_BLOCK = 10
"""Enough to pay for building a diagram, and that there are not too many files."""


@dataclass(frozen=True)
class Block:
    """Consecutive episodes of one object: what a worker takes and a file holds."""

    object: str
    first: int
    count: int
    job: int = 0
    """Index of its job among those that run together."""

    @property
    def diagram(self) -> tuple[int, str]:
        """Tells apart what needs another diagram: job and object."""
        return self.job, self.object

    @property
    def name(self) -> str:
        """File name without its ending."""
        return f"{self.object}-{self.first:06d}"

    def one(self, episode: int) -> "Block":
        """One of its episodes."""
        return replace(self, first=episode, count=1)

    def each(self) -> "Iterator[Block]":
        """Its episodes, one by one."""
        return (self.one(self.first + i) for i in range(self.count))

    def after(self, episode: int) -> "Block | None":
        """What follows one of its episodes, if anything does."""
        left = self.first + self.count - 1 - episode
        return replace(self, first=episode + 1, count=left) if left else None

    def __str__(self) -> str:
        last = self.first + self.count - 1
        return f"block {self.name} (episodes {self.first} to {last} of {self.object})"


@dataclass(frozen=True, kw_only=True)
class Job:
    """Episodes 0 to `episodes - 1` of every object."""

    scenario: Scenario
    """What every episode shares; its `object.name` is replaced by each of `objects`."""
    objects: tuple[str, ...]
    """Catalogue names."""
    episodes: int
    """Per object."""
    provenance: dict[str, str] = field(default_factory=dict)
    """What else decides the rows, such as a version or the digest of the weights."""

    @property
    def total(self) -> int:
        """Number of episodes over all objects."""
        return self.episodes * len(self.objects)

    def blocks(self, index: int = 0) -> Iterator[Block]:
        """Yields the blocks in the order of objects and episodes.

        Args:
            index: of the job among those that run together.
        """
        for name in self.objects:
            for first in range(0, self.episodes, EPISODES_PER_BLOCK):
                yield Block(name, first, min(EPISODES_PER_BLOCK, self.episodes - first), index)

    def describe(self) -> dict[str, object]:
        """Returns what, with the scenario, must agree for a run to be resumed."""
        return {"objects": list(self.objects), "episodes": self.episodes, **self.provenance}


def runs(episodes: Iterable[Block]) -> Iterator[Block]:
    """Joins single episodes of one block, in their order, where they follow each other."""
    run: Block | None = None
    for episode in episodes:
        if run is not None and run.first + run.count == episode.first:
            run = replace(run, count=run.count + 1)
            continue
        if run is not None:
            yield run
        run = episode
    if run is not None:
        yield run


def take_block(pending: list[Block], before: Block | None) -> Block:
    """Takes a block for which a diagram is built, or else of the diagram with most left.

    Args:
        pending: at least one block; the one that is taken leaves the list.
        before: what the worker ran last, if anything.
    """
    wanted = [block.diagram for block in pending]
    if before is not None and before.diagram in wanted:
        return pending.pop(wanted.index(before.diagram))
    counts = Counter(wanted)
    return pending.pop(wanted.index(max(counts, key=counts.__getitem__)))
