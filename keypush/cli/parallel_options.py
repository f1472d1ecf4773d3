"""What `collect`, `evaluate` and `reproduce` share: many episodes, on many workers."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import tyro

from keypush.cli.options import OBJECTS
from keypush.errors import UserError

if TYPE_CHECKING:
    from keypush.rollout.job import Job
    from keypush.scenario import Scenario


@dataclass(kw_only=True)
class WorkerOptions:
    """Where to, and how many at once."""

    after_interrupt: ClassVar[str] = (
        "finished episodes are kept; the same command goes on from them"
    )

    out: Path
    """Folder for the results; a stopped run goes on in it."""
    workers: int | None = None
    """Episodes that run at once; by default one per core. Results do not depend on it."""
    engine: Literal["local", "ray"] = "local"
    """Where they run: processes of this machine, or a Ray cluster (needs keypush[ray])."""


@dataclass(kw_only=True)
class ParallelOptions(WorkerOptions):
    """Of which objects besides."""

    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)]
    """Objects to push."""


def make_job(
    scenario: "Scenario", options: ParallelOptions, *, option: str, episodes: int
) -> "Job":
    """Checks the options and makes the job that they ask for.

    Args:
        scenario: what every episode shares.
        options: the shared options.
        option: name of the option that gave `episodes`.
        episodes: per object.

    Raises:
        UserError: an option is out of range, an object is not there, or see `provenance`.
    """
    from keypush.objects.library import parse_object_list
    from keypush.rollout.job import Job
    from keypush.rollout.provenance import provenance

    check_positive(option, episodes)
    check_positive("workers", options.workers)
    objects = parse_object_list(options.objects)
    return Job(
        scenario=scenario,
        objects=tuple(objects),
        episodes=episodes,
        provenance=provenance(scenario, objects),
    )


def check_positive(option: str, value: int | None) -> None:
    """Checks a number that is at least 1, where it is given.

    Raises:
        UserError: it is less.
    """
    if value is not None and value < 1:
        raise UserError(f"--{option} is {value}; allowed: 1 or more")
