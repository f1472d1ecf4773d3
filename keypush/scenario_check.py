"""Checks scenarios against their dataclasses, so that every mistake names its field.

`check_yaml` looks at parsed YAML before Drake reads it: Drake's own messages do not say which
field they are about. `check_values` looks at the ranges and choices that the fields' metadata
(`range`, `length`, `ordered`, `allowed`, `form`) gives.
"""

import dataclasses
import reprlib
import typing
from collections.abc import Mapping
from types import NoneType
from typing import Any

from keypush.errors import UserError

SURFACE_POINTS = 4096
"""Points known of an object's surface; the most that a cloud, of a run or a training, can have.

It stands here for those who read no scenario: Drake takes seconds to import.
"""
LARGEST_SEED = 2**53
"""Of a run or a training; up to here a float holds every whole number."""
_REPR = reprlib.Repr(maxlist=8, maxstring=60)
_ALLOWED = {bool: "true or false", str: "a text, in quotes if it looks like a number"}


def check_yaml(data: object, schema: type, section: str = "") -> None:
    """Checks that parsed YAML has only the schema's fields, each with a value of its type.

    Args:
        data: what the YAML holds; fields may be left out.
        schema: a dataclass whose fields are dataclasses, numbers, texts, booleans or lists.
        section: the name of the field that holds the data; empty at the top.

    Raises:
        UserError: names the field, what was found and what is allowed.
    """
    specs = {spec.name: spec for spec in dataclasses.fields(schema)}
    fields = ", ".join(specs)
    if not isinstance(data, dict):
        place = section or "the top level"
        raise UserError(f"{place} is {_found(data)}; allowed: a mapping with the fields {fields}")
    for key, value in data.items():
        name = key if isinstance(key, str) and key.isidentifier() else _found(key)
        if not section and name.startswith("_"):
            continue  # Drake passes over these: they hold templates for YAML's aliases
        full = f"{section}.{name}" if section else name
        if key not in specs:
            place = f"in {section}" if section else "at the top level"
            raise UserError(f"{full} is unknown; allowed {place}: {fields}")
        kind: Any = specs[key].type
        if isinstance(kind, type) and dataclasses.is_dataclass(kind):
            check_yaml(value, kind, full)
        elif not _fits(value, kind):
            raise UserError(f"{full} is {_found(value)}; allowed: {_allowed(specs[key])}")


def check_values(config: Any, prefix: str = "") -> None:
    """Checks every field of a dataclass, and of those inside it, against its metadata.

    Args:
        config: an instance of a dataclass.
        prefix: goes before the fields' names in messages.

    Raises:
        UserError: names the field, what it holds and what is allowed.
    """
    for spec in dataclasses.fields(config):
        value = getattr(config, spec.name)
        name = f"{prefix}{spec.name}"
        if dataclasses.is_dataclass(value):
            check_values(value, f"{name}.")
        elif "range" in spec.metadata and value is not None:
            _check_range(name, value, spec.metadata)
        elif "allowed" in spec.metadata and not _is_allowed(value, spec.metadata):
            raise UserError(f"{name} is {value!r}; allowed: {_allowed(spec)}")


def _is_allowed(value: Any, metadata: Mapping[str, Any]) -> bool:
    """Whether it is one of the words, or else of the form that is allowed too."""
    has_form = metadata["form"][0] if "form" in metadata else lambda _value: False
    return value in metadata["allowed"] or has_form(value)


def _check_range(name: str, value: Any, metadata: Mapping[str, Any]) -> None:
    low, high = metadata["range"]
    length = metadata.get("length")
    if length is not None and len(value) != length:
        raise UserError(f"{name} has {len(value)} entries; allowed: {length}")
    for number in value if length is not None else [value]:
        if not low <= number <= high:  # false for NaN too
            raise UserError(f"{name} is {_found(number)}; allowed: {_range(metadata)}")
    if metadata.get("ordered") and sorted(value) != list(value):
        raise UserError(f"{name} is {_found(value)}; allowed: none below the one before it")


def _fits(value: object, kind: Any) -> bool:
    """Whether Drake's reader turns the value into this type."""
    arguments = typing.get_args(kind)
    if typing.get_origin(kind) is list:
        return isinstance(value, list) and all(_fits(entry, arguments[0]) for entry in value)
    if arguments:  # a union such as `list[float] | None`
        return any(_fits(value, argument) for argument in arguments)
    if kind is NoneType:
        return value is None
    if kind in (int, float):
        return _is_number(value, kind)
    return type(value) is kind


def _is_number(value: object, kind: type[int] | type[float]) -> bool:
    """YAML 1.1 reads `1e-3` as a text, so that texts which Python can convert count too."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return False
    try:
        number = kind(value)
    except (ValueError, OverflowError):
        return False
    return kind is float or isinstance(value, str) or number == value


def _allowed(spec: "dataclasses.Field[Any]") -> str:
    if "allowed" in spec.metadata:
        return ", ".join([*spec.metadata["allowed"], *spec.metadata.get("form", ())[1:]])
    if "range" not in spec.metadata:
        return _ALLOWED.get(typing.cast("type", spec.type), "a list of two numbers, or null")
    length = spec.metadata.get("length")
    noun = "a whole number" if spec.type is int else "a number"
    return f"{noun if length is None else f'{length} numbers'} from {_range(spec.metadata)}"


def _range(metadata: Mapping[str, Any]) -> str:
    # Whole numbers in full: the largest seed has more digits than `g` prints.
    low, high = (
        str(limit) if isinstance(limit, int) else f"{limit:g}" for limit in metadata["range"]
    )
    return f"{low} to {high}"


def _found(value: object) -> str:
    """A value on one line of bounded length."""
    if value is None:
        return "null"
    try:
        return _REPR.repr(value)
    except ValueError:
        return "a whole number of thousands of digits"
