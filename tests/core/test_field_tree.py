"""Fields by dotted names, as a tree."""

from typing import Any

import pytest

from keypush.errors import UserError
from keypush.field_tree import put_field


def _tree(*given: tuple[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for name, value in given:
        put_field(tree, name, value)
    return tree


def test_names_with_dots_and_groups_come_to_the_same() -> None:
    dotted = _tree(("noise.a", 1), ("noise.b.c", [2, 3]), ("seed", 4))
    assert dotted == {"noise": {"a": 1, "b": {"c": [2, 3]}}, "seed": 4}
    assert _tree(("noise", {"a": 1, "b.c": [2, 3]}), ("seed", 4)) == dotted


def test_a_group_adds_to_what_was_given_before_and_the_last_value_counts() -> None:
    assert _tree(("noise.a", 1), ("noise", {"b": 2}), ("noise.b", 3)) == {"noise": {"a": 1, "b": 3}}


@pytest.mark.parametrize(
    "given",
    [
        (("noise", 3), ("noise.a", 1)),
        (("noise", 3), ("noise", {"a": 1})),
        (("noise.a", 3), ("noise", {"a": {"b": 1}})),
    ],
)
def test_a_value_is_not_a_group_too(given: tuple[tuple[str, Any], ...]) -> None:
    with pytest.raises(UserError, match="is given twice, as a value and as a group"):
        _tree(*given)
