"""YAML that somebody may have written by hand."""

import reprlib
from typing import Any

import yaml

from keypush.errors import UserError, one_line

_MOST_LEVELS = 20
"""What is nested more deeply would end in a RecursionError where it is written, or told."""


def parse_yaml(text: str, empty: Any = None) -> Any:
    """Parses YAML.

    Args:
        text: of one document.
        empty: what stands for a text that holds nothing but comments.

    Raises:
        UserError: it is no YAML, holds what cannot be read or a field twice; says why, but not
            where it is from.
    """
    try:
        loader = yaml.SafeLoader(text)
        root = loader.get_single_node()
        if root is None:
            return empty
        _check_nodes(root)
        return loader.construct_document(root)
    except UserError:
        raise
    # Not only YAMLError: ValueError for the date 2000-13-01, RecursionError for a thousand [.
    except Exception as error:
        raise UserError(f"not readable as YAML: {one_line(error)}") from error


def _check_nodes(root: yaml.Node) -> None:
    """Checks what PyYAML does not: how deep nodes are nested, and that no field is given twice."""
    seen, level = {id(root)}, [("", root)]
    for _ in range(_MOST_LEVELS):
        inner = [found for outer in level for found in _inside(*outer) if id(found[1]) not in seen]
        seen.update(id(node) for _, node in inner)  # an alias may lead back
        level = inner
    if level:
        raise UserError(
            f"not readable as YAML: line {_line(level[0][1])} is nested too deeply; "
            f"allowed: {_MOST_LEVELS} levels"
        )


def _inside(name: str, node: yaml.Node) -> list[tuple[str, yaml.Node]]:
    """Returns what a node holds, by names."""
    if isinstance(node, yaml.SequenceNode):
        return [(name, inner) for inner in node.value]
    if not isinstance(node, yaml.MappingNode):
        return []
    _refuse_twice(name, [key for key, _ in node.value])
    return [(_join(name, key), inner) for key, value in node.value for inner in (key, value)]


def _refuse_twice(name: str, keys: list[yaml.Node]) -> None:
    """PyYAML would take the last, which undoes all that a first section says."""
    lines: dict[tuple[str, str], int] = {}
    for key in keys:
        if not isinstance(key, yaml.ScalarNode):
            continue
        if (key.tag, key.value) in lines:
            raise UserError(
                f"{_join(name, key)} is given twice, in lines {lines[key.tag, key.value]} and "
                f"{_line(key)}; allowed: once"
            )
        lines[key.tag, key.value] = _line(key)


def _join(name: str, key: yaml.Node) -> str:
    text = str(key.value)
    return f"{name}.{text if text.isidentifier() else reprlib.repr(text)}".removeprefix(".")


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1
