"""Who may drive the tool: every policy by its name, and those that are somebody's own."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath

SHIPPED = "auto"
"""Stands for the weights that ship with keypush under the policy's own name."""


@dataclass(frozen=True, kw_only=True)
class Policy:
    """What the rest of the package has to know about a policy."""

    description: str
    """Who drives, in one line, as a page and the command line's help tell it."""
    uses_com: bool = False
    """Whether it sees the true centre of mass."""
    weights_kind: str | None = None
    """Kind of its weights (see `keypush.learning.kinds`); None where nothing was learned."""

    @property
    def acts(self) -> bool:
        """Whether a network chooses the tool's actions; else stages push at a contact."""
        return self.weights_kind == "behavior_cloning"


POLICIES: Mapping[str, Policy] = {
    "expert": Policy(
        description="the analytic expert, which knows the true pose and shape, chooses the contact",
        uses_com=True,
    ),
    "keypoint": Policy(
        description="the thesis' network predicts the keypoint from noisy cloud and centre of mass",
        uses_com=True,
        weights_kind="keypoint",
    ),
    "keypoint_no_com": Policy(
        description="the thesis' network predicts the keypoint from the noisy cloud",
        weights_kind="keypoint",
    ),
    "behavior_cloning": Policy(
        description="the thesis' network predicts the tool's action itself, without a keypoint",
        uses_com=True,
        weights_kind="behavior_cloning",
    ),
    "surface": Policy(
        description="a network picks the keypoint among points of the noisy cloud, "
        "and knows the centre of mass",
        uses_com=True,
        weights_kind="surface_keypoint",
    ),
    "surface_no_com": Policy(
        description="a network picks the keypoint among points of the noisy cloud",
        weights_kind="surface_keypoint",
    ),
    "geometric": Policy(
        description="no learning: the noisy cloud's outline behind the centre of mass",
        uses_com=True,
    ),
    "geometric_no_com": Policy(
        description="no learning: the noisy cloud's outline behind its centroid",
    ),
    "centroid": Policy(
        description="no learning: the keypoint is the centroid of the noisy cloud",
    ),
}


OWN_POLICY = "FILE.py:NAME, MODULE:NAME"
"""Forms of the name of a policy from outside the package."""
_OWN = Policy(description="a keypoint model of your own, which is no part of keypush")


def is_own_policy(name: str) -> bool:
    """Whether a name is one of `OWN_POLICY`; that what it names exists is not looked at."""
    source, _, made = name.rpartition(":")
    is_source = source.endswith(".py") or all(part.isidentifier() for part in source.split("."))
    return is_source and made.isidentifier()


def find_policy(name: str) -> Policy:
    """Returns what is to be known of a policy, one of the list or somebody's own.

    Raises:
        KeyError: there is no such policy.
    """
    return _OWN if is_own_policy(name) else POLICIES[name]


def policy_label(name: str) -> str:
    """Returns what a policy is called in results: its name, without the folder of its file."""
    source, colon, made = name.rpartition(":")
    return f"{PurePath(source).name}{colon}{made}"


def weights_name(policy: str, given: str) -> str:
    """Returns name or path of a policy's weights.

    Args:
        policy: its name.
        given: `predictor.weights` of the scenario.
    """
    return policy if given == SHIPPED else given
