"""What decides an episode beside scenario, object and number."""

import hashlib
from collections.abc import Sequence

from keypush import __version__
from keypush.learning.policy_model import policy_weights
from keypush.objects.library import object_folder, user_object_names
from keypush.policies import POLICIES
from keypush.scenario import Scenario


def provenance(scenario: Scenario, objects: Sequence[str]) -> dict[str, str]:
    """Returns keypush's version and digests of weights and of a user's objects.

    Raises:
        UserError: weights are not there or do not fit the policy.
    """
    return {
        "keypush": __version__,
        **_weights_digest(scenario),
        **_user_objects_digest(objects),
    }


def _weights_digest(scenario: Scenario) -> dict[str, str]:
    """Tells weights apart that were trained again under the same name."""
    if POLICIES[scenario.policy].weights_kind is None:
        return {}
    path, _ = policy_weights(scenario.policy, scenario.predictor.weights)
    return {"weights_sha256": hashlib.sha256(path.read_bytes()).hexdigest()}


def _user_objects_digest(names: Sequence[str]) -> dict[str, str]:
    """Tells objects apart that were removed and added again under the same name."""
    mine = set(user_object_names()).intersection(names)
    if not mine:
        return {}
    digest = hashlib.sha256()
    for name in sorted(mine):
        for path in sorted(object_folder(name).iterdir()):
            digest.update(path.read_bytes())
    return {"user_objects_sha256": digest.hexdigest()}
