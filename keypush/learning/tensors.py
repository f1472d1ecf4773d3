"""The tensors of a `.safetensors` file, taken by name and shape."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load

from keypush.errors import UserError, one_line

Array = NDArray[np.float64]
_NAMED = 4
"""So many names at most stand in a message."""


class Tensors:
    """Named arrays; what is missing or has another shape is told, all at once, at the end."""

    def __init__(self, source: str, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Args: what the arrays belong to, for the message; the arrays by their names."""
        self._source = source
        self._left = dict(arrays)
        self._missing: list[str] = []
        self._misshapen: list[str] = []

    @staticmethod
    def read(path: Path) -> "Tensors":
        """Reads a file.

        Raises:
            UserError: it cannot be read.
        """
        try:
            return Tensors(f"weights {path}", load(path.read_bytes()))
        except (OSError, SafetensorError, KeyError, TypeError, ValueError) as error:
            raise UserError(f"weights {path}: cannot be loaded: {one_line(error)}") from error

    def take(self, name: str, *shape: int) -> Array:
        """Returns an array; zeros in place of one that does not fit."""
        found = self._left.pop(name, None)
        if found is None:
            self._missing.append(name)
        elif found.shape != shape:
            self._misshapen.append(f"{name} has shape {found.shape}, expected {shape}")
        else:
            return found.astype(np.float64)
        return np.zeros(shape)

    def finish(self) -> None:
        """Checks that every array was taken, and every wanted one found.

        Raises:
            UserError: names those that do not fit.
        """
        problems = [
            f"{what}: {_some(names)}"
            for what, names in (("missing", self._missing), ("unexpected", sorted(self._left)))
            if names
        ]
        if self._misshapen:
            problems.append(_some(self._misshapen))
        if problems:
            raise UserError(f"{self._source}: cannot be loaded: {'; '.join(problems)}")


def _some(names: list[str]) -> str:
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")
