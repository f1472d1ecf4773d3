"""From an environment's arguments to a scenario and names of objects."""

import copy
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from keypush.errors import UserError
from keypush.field_tree import put_field
from keypush.objects.library import object_folder, object_names, parse_object_list
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
    try:
        tree: dict[str, Any] = {}
        for name, value in source.items():
            put_field(tree, str(name), _plain(value))
        text = yaml.safe_dump(tree)
    except (yaml.YAMLError, RecursionError) as error:
        raise UserError("scenario: allowed: numbers, texts, lists and mappings of them") from error
    return parse_scenario(text)


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
        return parse_object_list(_joined(several))
    return [checked_object(scenario.object.name if single is None else single)]


def checked_object(name: Any) -> str:
    """Returns the name of an object.

    Raises:
        UserError: it is no name, or there is no such object.
    """
    if not isinstance(name, str):
        raise UserError(f"object is {name!r}; allowed: {', '.join(object_names())}")
    object_folder(name)  # says so if there is none
    return name


def _joined(names: Any) -> str:
    """Names in one text, as on the command line."""
    if isinstance(names, str):
        return names
    if isinstance(names, Iterable):
        names = list(names)
        if all(isinstance(name, str) for name in names):
            return ",".join(names)
    raise UserError(f"objects is {names!r}; allowed: names in a list, or in one text")


def _plain(value: Any) -> Any:
    """Python's own numbers in place of NumPy's, which YAML does not know."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {name: _plain(inner) for name, inner in value.items()}
    return [_plain(entry) for entry in value] if isinstance(value, list | tuple) else value
