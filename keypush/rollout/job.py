"""A job: the same scenario for several objects and many episodes, cut into blocks."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from keypush.scenario import Scenario

EPISODES_PER_BLOCK = 10
"""Few, so that an interrupt loses little; enough to pay for building a diagram."""


@dataclass(frozen=True)
class Block:
    """Consecutive episodes of one object: what a worker takes and a file holds."""

    object: str
    first: int
    count: int

    @property
    def name(self) -> str:
        """File name without its ending."""
        return f"{self.object}-{self.first:06d}"

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

    def blocks(self) -> Iterator[Block]:
        """Yields the blocks in the order of objects and episodes."""
        for name in self.objects:
            for first in range(0, self.episodes, EPISODES_PER_BLOCK):
                yield Block(name, first, min(EPISODES_PER_BLOCK, self.episodes - first))

    def describe(self) -> dict[str, object]:
        """Returns what, with the scenario, must agree for a run to be resumed."""
        return {"objects": list(self.objects), "episodes": self.episodes, **self.provenance}


def take_block(pending: list[Block], built: str) -> Block:
    """Takes a block of the object whose diagram is built, or else of that with most left.

    Args:
        pending: at least one block; the one that is taken leaves the list.
        built: name of an object, "" for none.
    """
    names = [block.object for block in pending]
    name = built if built in names else max(names, key=names.count)
    return pending.pop(names.index(name))
