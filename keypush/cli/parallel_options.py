"""What `collect` and `evaluate` share: many episodes of many objects, on many workers."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import tyro

from keypush import __version__
from keypush.cli.options import OBJECTS
from keypush.errors import UserError

if TYPE_CHECKING:
    from keypush.rollout.job import Job
    from keypush.scenario import Scenario


@dataclass(kw_only=True)
class ParallelOptions:
    """Of which objects, where to, and how many at once."""

    after_interrupt: ClassVar[str] = "finished blocks are kept; the same command goes on from them"

    out: Path
    """Folder for the results; a stopped run goes on in it."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)]
    """Objects to push."""
    workers: int | None = None
    """Episodes that run at once; by default one per core. Results do not depend on it."""
    engine: Literal["local", "ray"] = "local"
    """Where they run: processes of this machine, or a Ray cluster (needs keypush[ray])."""


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
        UserError: an option is out of range, an object is not there, or weights are not there or
            do not fit the policy.
    """
    from keypush.objects.library import parse_object_list
    from keypush.rollout.job import Job

    for name, value in ((option, episodes), ("workers", options.workers)):
        if value is not None and value < 1:
            raise UserError(f"--{name} is {value}; allowed: 1 or more")
    objects = parse_object_list(options.objects)
    return Job(
        scenario=scenario,
        objects=tuple(objects),
        episodes=episodes,
        provenance={
            "keypush": __version__,
            **_weights_digest(scenario),
            **_user_objects_digest(objects),
        },
    )


def _weights_digest(scenario: "Scenario") -> dict[str, str]:
    """Tells weights apart that were trained again under the same name."""
    from keypush.policies import POLICIES

    if POLICIES[scenario.policy].weights_kind is None:
        return {}
    import hashlib

    from keypush.learning.policy_model import policy_weights

    path, _ = policy_weights(scenario.policy, scenario.predictor.weights)
    return {"weights_sha256": hashlib.sha256(path.read_bytes()).hexdigest()}


def _user_objects_digest(names: list[str]) -> dict[str, str]:
    """Tells objects apart that were removed and added again under the same name."""
    import hashlib

    from keypush.objects.library import object_folder, user_object_names

    mine = set(user_object_names()).intersection(names)
    if not mine:
        return {}
    digest = hashlib.sha256()
    for name in sorted(mine):
        for path in sorted(object_folder(name).iterdir()):
            digest.update(path.read_bytes())
    return {"user_objects_sha256": digest.hexdigest()}
