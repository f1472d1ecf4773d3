"""What decides an episode beside scenario, object and number."""

import hashlib
from collections.abc import Sequence

from keypush import __version__
from keypush.dataset.job_file import USER_OBJECTS
from keypush.errors import UserError
from keypush.learning.own_policy import own_model, source_file
from keypush.learning.policy_model import check_weights
from keypush.objects.library import user_objects_digest
from keypush.policies import find_policy, is_own_policy
from keypush.rollout.job import Job
from keypush.scenario import Scenario

WEIGHTS = "weights_sha256"
OWN_POLICY = "policy_sha256"
"""Fields of job.yaml, beside `USER_OBJECTS`."""


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


_FILES = {
    WEIGHTS: "the file of the weights",
    OWN_POLICY: "the file of the policy",
    USER_OBJECTS: "files of your own objects",
}


def check_provenance(job: Job) -> None:
    """Checks that what decides a job's episodes is the same on this machine, where it is told.

    Raises:
        UserError: it is not, or a file is missing.
    """
    if not job.provenance:
        return
    found = provenance(job.scenario, job.objects)
    different = [text for key, text in _FILES.items() if found.get(key) != job.provenance.get(key)]
    if different:
        raise UserError(
            f"other than where the command was given: {', '.join(different)}; allowed: the same "
            "content at the same place"
        )


def _weights_digest(scenario: Scenario) -> dict[str, str]:
    """Tells weights apart that were trained again under the same name."""
    if find_policy(scenario.policy).weights_kind is None:
        return {}
    # What is wrong is told before a folder is theirs: with other weights it would be refused.
    path = check_weights(scenario.policy, scenario.predictor.weights, scenario.noise.cloud_points)
    return {WEIGHTS: hashlib.sha256(path.read_bytes()).hexdigest()}


def _own_policy_digest(policy: str) -> dict[str, str]:
    """Tells apart what a user's file held; of what that imports nothing is known."""
    if not is_own_policy(policy):
        return {}
    own_model(policy)  # A mistake in it is told before there are folders and processes.
    return {OWN_POLICY: hashlib.sha256(source_file(policy).read_bytes()).hexdigest()}


def _user_objects_digest(names: Sequence[str]) -> dict[str, str]:
    digest = user_objects_digest(names)
    return {} if digest is None else {USER_OBJECTS: digest}
