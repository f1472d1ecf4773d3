"""From an environment's arguments to a scenario and names of objects."""

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from keypush.errors import UserError
from keypush.objects.library import object_folder, parse_object_list
from keypush.scenario import Scenario, load_scenario, parse_scenario

ScenarioSource = Scenario | str | Path | Mapping[str, Any]


def resolve_scenario(source: ScenarioSource | None) -> Scenario:
    """Returns a checked scenario of the caller's own.

    Args:
        source: a scenario, the path of its YAML, or fields by their YAML names, nested or with
            dots; None for the defaults.

    Raises:
        UserError: unreadable file, unknown field, a value out of range.
    """
    if isinstance(source, Scenario):
        source.validate()
        return copy.deepcopy(source)
    if isinstance(source, str | Path):
        return load_scenario(source)
    if source is None:
        return Scenario()
    if not isinstance(source, Mapping):
        raise UserError(f"scenario is {source!r}; allowed: a Scenario, a path, a mapping of fields")
    tree: dict[str, Any] = {}
    for name, value in source.items():
        _put(tree, str(name), value)
    try:
        return parse_scenario(yaml.safe_dump(tree))
    except yaml.YAMLError as error:
        raise UserError("scenario: allowed: numbers, texts, lists and mappings of them") from error


def resolve_objects(
    single: str | None, several: str | Sequence[str] | None, scenario: Scenario
) -> list[str]:
    """Returns the names of the objects that episodes draw from.

    Args:
        single: a name.
        several: names, or names and groups in one text as on the command line.
        scenario: has the object where neither is given.

    Raises:
        UserError: both are given, or there is no such object.
    """
    if single is not None and several is not None:
        raise UserError("object and objects are both given; allowed: one of them")
    if several is not None:
        return parse_object_list(several if isinstance(several, str) else ",".join(several))
    name = scenario.object.name if single is None else single
    object_folder(name)  # says so if there is none
    return [name]


def _put(tree: dict[str, Any], dotted: str, value: Any) -> None:
    *path, leaf = dotted.split(".")
    for name in path:
        tree = tree.setdefault(name, {})
        if not isinstance(tree, dict):
            raise UserError(f"field {dotted}: {name} is given twice, as a value and as a group")
    if isinstance(value, Mapping):
        for name, inner in value.items():
            _put(tree.setdefault(leaf, {}), str(name), inner)
    else:
        tree[leaf] = value
