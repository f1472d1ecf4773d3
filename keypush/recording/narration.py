"""An episode's outcome in plain words."""

from dataclasses import dataclass

import numpy as np

from keypush.learning.card import trained_objects
from keypush.policies import find_policy, policy_label, weights_name
from keypush.rollout.episode import EpisodeResult
from keypush.scenario import Scenario

_FAILURES = {
    "toppled": "the {object} toppled",
    "fell": "the {object} fell off the table",
    "timed_out": "time ran out",
    "policy_failed": "the policy failed ({reason})",
}


@dataclass(frozen=True)
class Narration:
    """What happened, in words."""

    title: str
    policy: str
    outcome: str

    def __str__(self) -> str:
        """The whole story, one sentence a line."""
        return "\n".join([self.title, self.policy, self.outcome])


def narrate(scenario: Scenario, result: EpisodeResult) -> Narration:
    """Tells which object was pushed, by whom, and how it ended."""
    shown = scenario.object.name.replace("_", " ")
    policy = f"{policy_label(scenario.policy)} ({find_policy(scenario.policy).description})"
    return Narration(
        title=f"A Franka Panda pushes the {shown}{_familiarity(scenario)}.",
        policy=f"Policy: {policy}.",
        outcome=_outcome(scenario, result, shown),
    )


def _familiarity(scenario: Scenario) -> str:
    """Whether who drives has seen the object before; nothing where nobody has learned."""
    if find_policy(scenario.policy).weights_kind is None:
        return ""
    weights = weights_name(scenario.policy, scenario.predictor.weights)
    seen = scenario.object.name in trained_objects(weights)
    return ", a shape of its training set" if seen else ", a shape that it never saw in training"


def final_distance(result: EpisodeResult) -> float:
    """Returns the distance in m, in xy, of the object's origin from the goal at the end."""
    position = np.asarray(result.summary["final_position"])[:2]
    return float(np.linalg.norm(position - result.rows["goal"][-1]))


def _outcome(scenario: Scenario, result: EpisodeResult, shown: str) -> str:
    summary = result.summary
    steps = f"after {summary['steps']} policy steps"
    seconds = float(str(summary["steps"])) * scenario.episode.policy_period
    distance = f"{100 * final_distance(result):.1f} cm from the goal's centre"
    allowed = f"{100 * scenario.episode.goal_radius:g} cm allowed"
    if not summary["success"]:
        cause = _FAILURES[str(summary["outcome"])].format(
            object=shown, reason=summary.get("reason", "")
        )
        return f"Goal not reached: {cause} {steps} ({seconds:.1f} s), {distance} ({allowed})."
    end = f"the {shown} was {distance} ({allowed})"
    if summary["settled_success"]:
        return f"Goal reached {steps} ({seconds:.1f} s); at the end, at rest and upright, {end}."
    return f"Goal reached {steps} ({seconds:.1f} s), but not held: at the end {end}."
