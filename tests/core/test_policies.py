"""The registry of policies, and the models and weights that fit them."""

from pathlib import Path
from typing import Any

import pytest

from keypush.errors import UserError
from keypush.learning.checkpoint import save_network
from keypush.learning.eager import random_network
from keypush.learning.kinds import KINDS
from keypush.learning.policy_model import policy_model, policy_weights
from keypush.policies import (
    POLICIES,
    SHIPPED,
    find_policy,
    is_own_policy,
    policy_label,
    weights_name,
)

LEARNED = [name for name, policy in POLICIES.items() if policy.weights_kind is not None]
AIMING_BY_HAND = [name for name in POLICIES if name not in LEARNED]


def _save(policy: str, path: Path, *, flip_com: bool = False) -> Path:
    needs = POLICIES[policy]
    kind = needs.weights_kind
    assert kind is not None
    config: Any = KINDS[kind]
    save_network(
        random_network(kind, config(use_com=needs.uses_com != flip_com)),
        path,
        {"action_clips": {"translation": 0.06, "rotation": 0.1}},
    )
    return path


def test_policies_are_told_in_one_line_and_need_known_weights() -> None:
    for policy in POLICIES.values():
        assert policy.description
        assert "\n" not in policy.description
        assert policy.weights_kind is None or policy.weights_kind in KINDS
    assert len({policy.description for policy in POLICIES.values()}) == len(POLICIES)


def test_weights_are_the_policys_own_unless_others_are_named() -> None:
    assert weights_name("surface", SHIPPED) == "surface"
    assert weights_name("surface", "mine.safetensors") == "mine.safetensors"


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("mine.py:Ray", "mine.py:Ray"),
        ("../some folder/mine.py:Ray", "mine.py:Ray"),
        ("package.module:make", "package.module:make"),
    ],
)
def test_somebodys_own_policy_is_told_by_file_and_name(name: str, label: str) -> None:
    assert is_own_policy(name)
    assert policy_label(name) == label
    assert find_policy(name).weights_kind is None


@pytest.mark.parametrize("name", [*POLICIES, "", ":", "mine.py", "mine.py:", ":Ray", "a b:Ray",
                                  "folder/mine.txt:Ray", "mine.py:3"])  # fmt: skip
def test_other_names_are_nobodys_own(name: str) -> None:
    assert not is_own_policy(name)
    assert name not in POLICIES or policy_label(name) == name


@pytest.mark.parametrize("policy", AIMING_BY_HAND)
def test_without_learning_no_weights_are_looked_for(policy: str) -> None:
    model = policy_model(policy, "no_such_weights")
    assert (model is None) == (policy == "expert")
    if model is not None:
        assert model.uses_com == POLICIES[policy].uses_com


@pytest.mark.parametrize("policy", LEARNED)
def test_weights_that_fit_are_read_and_others_refused_by_reason(
    policy: str, tmp_path: Path
) -> None:
    needs = POLICIES[policy]
    path = _save(policy, tmp_path / "w.safetensors")
    model = policy_model(policy, str(path))
    assert model is not None
    assert model.uses_com == POLICIES[policy].uses_com
    _save(policy, path, flip_com=True)
    with pytest.raises(UserError, match=rf"^policy {policy}: weights .*: use_com is .*; allowed: "):
        policy_weights(policy, str(path))
    other = "surface" if POLICIES[policy].weights_kind != "surface_keypoint" else "keypoint"
    _save(other, path)
    with pytest.raises(UserError, match=rf"^policy {policy}: .*kind is .*allowed here: "):
        policy_weights(policy, str(path))
    with pytest.raises(UserError, match=rf"^policy {policy}: weights 'none': no file ") as caught:
        policy_weights(policy, "none")
    named = str(caught.value).partition("(")[2].partition(")")[0].split(", ")
    assert set(named) == {p for p in LEARNED if POLICIES[p].weights_kind == needs.weights_kind}
