"""What the files beside records say of how they were made."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from keypush.errors import UserError
from keypush.yaml_text import parse_yaml


def read_settings(path: Path) -> dict[str, Any]:
    """Reads scenario.yaml or job.yaml; records stand alone, so that a missing one says nothing.

    Returns:
        Values by their names, those of a field in a section joined by dots.
    """
    try:
        content = parse_yaml(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, UserError):
        return {}
    return dict(_flat(content)) if isinstance(content, dict) else {}


def _flat(section: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in section.items():
        if isinstance(value, dict) and not prefix:  # no section has sections of its own
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
