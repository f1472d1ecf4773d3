"""What is run to reproduce the thesis' tables: objects, sizes, shifts and episodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from keypush.errors import UserError
from keypush.evaluation.conditions import grid
from keypush.learning.policy_model import policy_weights
from keypush.objects.catalogue import catalogue_names
from keypush.policies import POLICIES, SHIPPED
from keypush.reproduction.thesis_figures import COM_SHIFT, SHIFTED, SIZES
from keypush.rollout.job import Job
from keypush.rollout.provenance import provenance
from keypush.scenario import Scenario
from keypush.seeding import EVALUATION_SEEDS

REPRODUCED = (
    "keypoint", "keypoint_no_com", "behavior_cloning", "surface", "surface_no_com", "geometric",
    "geometric_no_com", "expert",
)  # fmt: skip
"""Policies, the thesis' own first."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How much is run, of each policy."""

    objects: tuple[str, ...]
    """In every size."""
    sizes: tuple[float, ...]
    shifted: tuple[str, ...]
    """Objects that are also run with a shifted centre of mass, in their own size."""
    episodes: int
    """Per object and condition."""

    @property
    def total(self) -> int:
        """Number of episodes of a policy."""
        return (len(self.objects) * len(self.sizes) + len(self.shifted)) * self.episodes

    def jobs(self, policy: str) -> list[Job]:
        """Returns the jobs of a policy, one for each condition, what tells most first.

        Raises:
            UserError: its weights do not ship.
        """
        scenario = Scenario(policy=policy, seed=EVALUATION_SEEDS)
        job = Job(
            scenario=scenario,
            objects=self.objects,
            episodes=self.episodes,
            provenance=provenance(scenario, self.objects),
        )
        first, *sizes = [replace(job, scenario=s) for s in grid(scenario, {"sizes": self.sizes})]
        (heavy,) = grid(scenario, {"com-shifts": [COM_SHIFT]})
        return [first, replace(job, scenario=heavy, objects=self.shifted), *sizes]


PLANS: Mapping[str, Plan] = {
    "full": Plan(
        objects=tuple(catalogue_names()),
        sizes=SIZES,
        shifted=tuple(catalogue_names()),
        episodes=50,
    ),
    # The objects of table 5.8, every second one of id, every third one of ood.
    "quick": Plan(
        objects=(*SHIFTED, *catalogue_names("id")[::2], *catalogue_names("ood")[::3]),
        sizes=(1.0, 0.75, 1.25),
        shifted=tuple(SHIFTED),
        episodes=5,
    ),
}
"""By scale. The episodes of "quick" are the first ones of "full"."""


def check_policies(policies: Sequence[str]) -> None:
    """Checks the policies before anything runs.

    Raises:
        UserError: one is unknown or given twice, or weights do not ship.
    """
    for policy in policies:
        if policy not in REPRODUCED:
            raise UserError(f"--policies has {policy!r}; allowed: {', '.join(REPRODUCED)}")
        if policies.count(policy) > 1:
            raise UserError(f"--policies has {policy} twice; allowed: each once")
    missing = [policy for policy in policies if not _can_run(policy)]
    if missing:
        left = " ".join(policy for policy in policies if policy not in missing)
        raise UserError(
            f"weights of {', '.join(missing)}: none that fit ship; allowed: to leave these out"
            + (f" (--policies {left})" if left else "")
        )


def _can_run(policy: str) -> bool:
    if POLICIES[policy].weights_kind is None:
        return True
    try:
        policy_weights(policy, SHIPPED)
    except UserError:
        return False
    return True
