"""The tensors of weights, taken by name and shape.

A head on a frozen encoder does not repeat it: its card names the file that holds the encoder.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load

from keypush.errors import UserError, one_line
from keypush.learning.card import is_file, read_card

Array = NDArray[np.float64]
ENCODER = "encoder."
"""How the names of an encoder's tensors begin, in weights of every kind."""
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
        """Reads a file, and the encoder from the one that its card names, if it names one.

        Raises:
            UserError: one of them cannot be read, or the encoder is not the one of the training.
        """
        arrays = _load(path, _content(path))
        encoder = read_card(path).get("encoder")
        if encoder is not None:
            arrays |= _read_encoder(path, encoder)
        return Tensors(f"weights {path}", arrays)

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


def encoder_record(weights: Path) -> dict[str, str]:
    """What the card of a head tells of the weights whose encoder it stands on."""
    return {"file": weights.name, "sha256": hashlib.sha256(weights.read_bytes()).hexdigest()}


def _read_encoder(head: Path, named: Any) -> dict[str, NDArray[np.generic]]:
    """Reads the encoder beside a head."""
    try:
        path, wanted = head.with_name(Path(named["file"]).name), named["sha256"]
    except (TypeError, KeyError, ValueError) as error:
        raise UserError(
            f"weights' card {head.with_suffix('.json')}: encoder is {named!r}; "
            "allowed: the file's name and its sha256"
        ) from error
    if not is_file(path):
        raise UserError(
            f"weights {head}: their encoder {path} is missing; allowed: the file that was beside "
            "them when they were trained"
        )
    content = _content(path)
    found = hashlib.sha256(content).hexdigest()
    if found != wanted:
        raise UserError(
            f"weights {head}: their encoder {path} has sha256 {found[:12]}; allowed: the one that "
            f"they were trained on, {str(wanted)[:12]}"
        )
    return {name: v for name, v in _load(path, content).items() if name.startswith(ENCODER)}


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise UserError(f"weights {path}: cannot be loaded: {one_line(error)}") from error


def _load(path: Path, content: bytes) -> dict[str, NDArray[np.generic]]:
    try:
        arrays: dict[str, NDArray[np.generic]] = load(content)
    except (SafetensorError, KeyError, TypeError, ValueError) as error:
        raise UserError(f"weights {path}: cannot be loaded: {one_line(error)}") from error
    return arrays


def _some(names: list[str]) -> str:
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")
