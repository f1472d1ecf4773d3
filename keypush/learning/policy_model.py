"""From a policy's name to the model that it asks, with the weights that fit it."""

from pathlib import Path
from typing import Any

from keypush.errors import UserError
from keypush.learning.baselines import CentroidKeypoint, GeometricKeypoint
from keypush.learning.card import weights_path
from keypush.learning.kinds import read_sizes
from keypush.learning.model import PolicyModel
from keypush.learning.own_policy import own_model
from keypush.learning.predict import check_cloud_points, read_model
from keypush.policies import POLICIES, is_own_policy, weights_name


def policy_weights(policy: str, given: str) -> tuple[Path, Any]:
    """Finds the weights of a policy that has learned.

    Args:
        policy: its name; its `weights_kind` is not None.
        given: `predictor.weights` of the scenario.

    Returns:
        The `.safetensors` file and the configuration of its network.

    Raises:
        UserError: there are no such weights, or they are not what the policy needs.
    """
    needs = POLICIES[policy]
    assert needs.weights_kind is not None
    try:
        path = weights_path(weights_name(policy, given), [needs.weights_kind])
        _, sizes = read_sizes(path, [needs.weights_kind])
    except UserError as error:
        raise UserError(f"policy {policy}: {error}") from error
    if sizes.use_com != needs.uses_com:
        found, wanted = (str(value).lower() for value in (sizes.use_com, needs.uses_com))
        fits = [
            name
            for name, other in POLICIES.items()
            if (other.weights_kind, other.uses_com) == (needs.weights_kind, sizes.use_com)
        ]
        instead = f"; policy {fits[0]} takes these weights" if fits else ""
        raise UserError(
            f"policy {policy}: weights {path}: use_com is {found}; allowed: {wanted}{instead}"
        )
    return path, sizes


def check_weights(policy: str, given: str, cloud_points: int) -> Path:
    """Checks the weights of a policy as its episodes need them; arguments as `policy_weights`.

    Args:
        cloud_points: `noise.cloud_points` of the scenario.

    Returns:
        The `.safetensors` file.

    Raises:
        UserError: see `policy_weights`, `read_model` and `check_cloud_points`.
    """
    path, sizes = policy_weights(policy, given)
    kind = POLICIES[policy].weights_kind
    assert kind is not None
    read_model(kind, path, sizes)
    check_cloud_points(cloud_points, sizes)
    return path


def policy_model(policy: str, given: str) -> PolicyModel | None:
    """Makes the model of a policy; None for the expert, which asks none.

    Args:
        policy: its name.
        given: `predictor.weights` of the scenario.

    Raises:
        UserError: see `policy_weights`, or the weights cannot be read; see `own_model`.
    """
    if is_own_policy(policy):
        return own_model(policy)
    needs = POLICIES[policy]
    if policy == "expert":
        return None
    if policy == "centroid":
        return CentroidKeypoint()
    if needs.weights_kind is None:
        return GeometricKeypoint(uses_com=needs.uses_com)
    path, sizes = policy_weights(policy, given)
    return read_model(needs.weights_kind, path, sizes)
