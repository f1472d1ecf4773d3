"""Where weights lie, and the card beside them: what they are and how they came about."""

import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from keypush.errors import UserError, one_line
from keypush.resources import weights_dir

SUFFIX = ".safetensors"


def weights_path(name_or_path: str | Path, kinds: Collection[str] = ()) -> Path:
    """Finds the `.safetensors` file.

    Args:
        name_or_path: name of weights that ship with keypush, or path of a `.safetensors` file.
        kinds: of which the weights have to be, for the message alone; empty: any.

    Raises:
        UserError: there is none.
    """
    given = Path(name_or_path)
    path = given if given.suffix == SUFFIX else weights_dir() / f"{name_or_path}{SUFFIX}"
    if not is_file(path):
        shipped = sorted(
            p.stem for p in weights_dir().glob(f"*{SUFFIX}") if not kinds or _kind(p) in kinds
        )
        names = ", ".join(shipped) if shipped else "none"
        raise UserError(
            f"weights {str(name_or_path)!r}: no file {path}; allowed: a name in {weights_dir()} "
            f"({names}) or the path of a {SUFFIX} file"
        )
    return path


def _kind(weights: Path) -> str:
    """The kind of weights; empty where their card tells none."""
    try:
        return str(read_card(weights).get("kind", ""))
    except UserError:
        return ""


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name that the file system refuses is none."""
    try:
        return path.is_file()
    except OSError:
        return False


def read_card(weights: Path) -> Mapping[str, Any]:
    """Reads the card of a `.safetensors` file, the `.json` beside it.

    Raises:
        UserError: it cannot be read or is no JSON object.
    """
    path = weights.with_suffix(".json")
    try:
        card = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"weights' card {path}: cannot be read: {one_line(error)}") from error
    except (ValueError, RecursionError) as error:
        raise UserError(f"weights' card {path}: no JSON: {one_line(error)}") from error
    if not isinstance(card, dict):
        raise UserError(f"weights' card {path}: found {type(card).__name__}; allowed: an object")
    return card


def trained_objects(name_or_path: str | Path) -> frozenset[str]:
    """Returns the names of the objects that weights were trained on; none if the card has none.

    Raises:
        UserError: weights or card cannot be read, or the card has something else in their place.
    """
    path = weights_path(name_or_path)
    data = read_card(path).get("data", {})
    names = data.get("objects", []) if isinstance(data, dict) else []
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise UserError(
            f"weights' card {path.with_suffix('.json')}: data.objects is {names!r}; allowed: a "
            "list of names"
        )
    return frozenset(names)
