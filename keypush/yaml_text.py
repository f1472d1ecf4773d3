"""YAML that somebody may have written by hand."""

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
        UserError: it is no YAML, or holds what cannot be read; says why, but not where it is from.
    """
    try:
        root = yaml.compose(text, yaml.SafeLoader)
        if root is None:
            return empty
        _check_levels(root)
        return yaml.safe_load(text)
    except UserError:
        raise
    # Not only YAMLError: ValueError for the date 2000-13-01, RecursionError for a thousand [.
    except Exception as error:
        raise UserError(f"not readable as YAML: {one_line(error)}") from error


def _check_levels(root: yaml.Node) -> None:
    seen, level = {id(root)}, [root]
    for _ in range(_MOST_LEVELS):
        inner = [node for outer in level for node in _inside(outer) if id(node) not in seen]
        seen.update(map(id, inner))  # an alias may lead back
        level = inner
    if level:
        raise UserError(
            f"not readable as YAML: line {level[0].start_mark.line + 1} is nested too deeply; "
            f"allowed: {_MOST_LEVELS} levels"
        )


def _inside(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [inner for pair in node.value for inner in pair]
    return list(node.value) if isinstance(node, yaml.SequenceNode) else []
