"""What decides an episode beside scenario, object and number."""

import hashlib
from collections.abc import Sequence

from keypush import __version__
from keypush.dataset.job_file import USER_OBJECTS
from keypush.learning.own_policy import own_model, source_file
from keypush.learning.policy_model import check_weights
from keypush.objects.library import user_objects_digest
from keypush.policies import find_policy, is_own_policy
from keypush.scenario import Scenario


def provenance(scenario: Scenario, objects: Sequence[str]) -> dict[str, str]:
    """Returns keypush's version and digests of weights, of a user's policy and objects.

    Raises:
        UserError: weights are not there, damaged, or do not fit the policy or the cloud, or it is
            a user's own and cannot be made.
    """
    return {
        "keypush": __version__,
        **_weights_digest(scenario),
        **_own_policy_digest(scenario.policy),
        **_user_objects_digest(objects),
    }


def _weights_digest(scenario: Scenario) -> dict[str, str]:
    """Tells weights apart that were trained again under the same name."""
    if find_policy(scenario.policy).weights_kind is None:
        return {}
    # What is wrong is told before a folder is theirs: with other weights it would be refused.
    path = check_weights(scenario.policy, scenario.predictor.weights, scenario.noise.cloud_points)
    return {"weights_sha256": hashlib.sha256(path.read_bytes()).hexdigest()}


def _own_policy_digest(policy: str) -> dict[str, str]:
    """Tells apart what a user's file held; of what that imports nothing is known."""
    if not is_own_policy(policy):
        return {}
    own_model(policy)  # A mistake in it is told before there are folders and processes.
    return {"policy_sha256": hashlib.sha256(source_file(policy).read_bytes()).hexdigest()}


def _user_objects_digest(names: Sequence[str]) -> dict[str, str]:
    digest = user_objects_digest(names)
    return {} if digest is None else {USER_OBJECTS: digest}
