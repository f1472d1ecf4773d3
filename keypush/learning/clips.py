"""The clips of the tool action, in which behaviour cloning counts."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from keypush.errors import UserError
from keypush.learning.card import read_card
from keypush.scenario import ControlConfig


@dataclass(frozen=True)
class Clips:
    """What is 1 in the target of behaviour cloning."""

    translation: float
    """m per axis."""
    rotation: float
    """rad per axis."""

    @staticmethod
    def of(control: ControlConfig) -> "Clips":
        """Those of a scenario."""
        return Clips(control.max_translation, control.max_rotation)

    @staticmethod
    def read(weights: Path) -> "Clips":
        """Those that weights were trained with, from their card.

        Raises:
            UserError: the card cannot be read or has none.
        """
        told = read_card(weights).get("action_clips")
        try:
            clips = Clips(**{name: float(value) for name, value in dict(told).items()})  # type: ignore[arg-type]  # None is refused below
            fine = bool((clips.of_action > 0).all() and np.isfinite(clips.of_action).all())
        except (TypeError, ValueError, OverflowError):
            fine = False
        if not fine:
            raise UserError(
                f"weights' card {weights.with_suffix('.json')}: action_clips is {told!r}; allowed: "
                "translation in m and rotation in rad, both above 0"
            )
        return clips

    @property
    def of_action(self) -> NDArray[np.float64]:
        """The clip of every entry of an action, (6,)."""
        return np.repeat([self.translation, self.rotation], 3)
