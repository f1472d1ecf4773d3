"""What runs blocks somewhere: processes of this machine, or a Ray cluster."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn, Protocol, Self

from keypush.errors import UserError
from keypush.rollout.job import Block
from keypush.rollout.worker import EpisodeDone, Failed


@dataclass(frozen=True)
class Lost:
    """Event: the process that ran a block died; the engine runs again what it has not told of."""

    how: str
    """Completes "the process that ran it ..."."""


Event = EpisodeDone | Lost


class Engine(Protocol):
    """A context manager: workers exist inside."""

    workers: int
    """How many blocks run at once; known inside."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *error: object) -> None: ...

    def run(self, pending: list[Block]) -> Iterator[tuple[Block, Event]]:
        """Runs blocks, which it takes out of the list, and yields what happens as it comes.

        `EpisodeDone` comes once for every episode, with that episode as its block; `Lost` comes
        with what is left of the block.

        Raises:
            UserError: a worker met a mistake of the user's.
            RuntimeError: a worker raised.
        """
        ...


def raise_failure(failed: Failed, block: Block) -> NoReturn:
    """Raises what a worker met.

    Raises:
        UserError: it was a mistake of the user's.
        RuntimeError: it was anything else.
    """
    if failed.by_user:
        raise UserError(failed.text)
    raise RuntimeError(f"{block} failed in its process:\n{failed.text}")
