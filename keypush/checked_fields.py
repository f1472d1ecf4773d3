"""Fields of configurations with what they allow, which `scenario_check.check_values` checks."""

from dataclasses import field
from typing import Any


def number(default: float | None, low: float, high: float) -> Any:
    """A numeric field with its closed range of allowed values."""
    return field(default=default, metadata={"range": (low, high)})


def vector(default: list[float], low: float, high: float) -> Any:
    """A fixed-length list field whose every entry has the same closed range."""
    return field(
        default_factory=lambda: list(default),
        metadata={"range": (low, high), "length": len(default)},
    )


def factors(low: float, high: float) -> Any:
    """The lowest and the highest factor on another field, by default 1 and 1."""
    return field(
        default_factory=lambda: [1.0, 1.0],
        metadata={"range": (low, high), "length": 2, "ordered": True},
    )


def choice(default: str, allowed: tuple[str, ...]) -> Any:
    """A text field that holds one of a few words; Drake's YAML schemas know no `Literal`."""
    return field(default=default, metadata={"allowed": allowed})
