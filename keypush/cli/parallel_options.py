"""What `collect` and `evaluate` share: many episodes of many objects, over processes."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import tyro

from keypush import __version__
from keypush.cli.options import OBJECTS
from keypush.cli.output import prepare_output_dir
from keypush.errors import UserError

if TYPE_CHECKING:
    from keypush.rollout.store import EpisodeStore
    from keypush.scenario import Scenario


@dataclass(kw_only=True)
class ParallelOptions:
    """Which episodes to run, where to, and over how many processes."""

    after_interrupt: ClassVar[str] = "finished blocks are kept; the same command goes on from them"

    out: Path
    """Folder for the results; a stopped run goes on in it."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)]
    """Objects to push."""
    episodes: int
    """Episodes per object."""
    processes: int | None = None
    """Processes that run at once; by default one per core. Results do not depend on it."""


def run_episodes(scenario: "Scenario", options: ParallelOptions) -> "EpisodeStore":
    """Checks the options and runs or resumes the job that they ask for.

    Raises:
        UserError: an option is out of range, or see `run_job`.
    """
    from keypush.objects.library import parse_object_list
    from keypush.rollout.job import Job
    from keypush.rollout.parallel import run_job

    processes = len(os.sched_getaffinity(0)) if options.processes is None else options.processes
    for name, value in (("episodes", options.episodes), ("processes", processes)):
        if value < 1:
            raise UserError(f"--{name} is {value}; allowed: 1 or more")
    job = Job(
        scenario=scenario,
        objects=tuple(parse_object_list(options.objects)),
        episodes=options.episodes,
        provenance={"keypush": __version__, **_weights_digest(scenario)},
    )
    return run_job(job, prepare_output_dir(options.out), processes=processes)


def _weights_digest(scenario: "Scenario") -> dict[str, str]:
    """Tells weights apart that were trained again under the same name."""
    if scenario.policy != "keypoint":
        return {}
    import hashlib

    from keypush.learning.checkpoint import weights_path

    content = weights_path(scenario.predictor.weights).read_bytes()
    return {"weights_sha256": hashlib.sha256(content).hexdigest()}
