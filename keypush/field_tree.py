"""Fields by names with dots, as the command line and programs give them, gathered into a tree."""

from collections.abc import Mapping
from typing import Any

from keypush.errors import UserError


def put_field(tree: dict[str, Any], dotted: str, value: Any) -> None:
    """Puts a field where its name says; a mapping adds its fields to those that are there.

    Raises:
        UserError: a name on the way is given as a value and as a group of fields.
    """
    *path, leaf = dotted.split(".")
    for name in path:
        tree = _group(tree, name, dotted)
    if not isinstance(value, Mapping):
        tree[leaf] = value
        return
    group = _group(tree, leaf, dotted)
    for name, inner in value.items():
        put_field(group, str(name), inner)


def _group(tree: dict[str, Any], name: str, dotted: str) -> dict[str, Any]:
    group: Any = tree.setdefault(name, {})
    if not isinstance(group, dict):
        raise UserError(f"field {dotted}: {name} is given twice, as a value and as a group")
    return group
