"""The trainings that have a name."""

from typing import Any

from keypush.learning.imitation.config import ImitationConfig
from keypush.presets import with_preset

PRESETS: dict[str, dict[str, Any]] = {
    "affordable": {},
    "thesis": {
        "rows_per_object": 0,
        "batch": 64,
        "learning_rate": 4e-4,
        "dropout": 0.1,
        "cache": False,
    },
}
"""Fields of `ImitationConfig` that differ from their defaults, by name."""


def preset_config[Config: ImitationConfig](config: Config, name: str) -> Config:
    """Returns the settings of a preset.

    Args:
        config: its fields stay what they are where they differ from the defaults.
        name: one of `PRESETS`.

    Raises:
        UserError: there is no such preset.
    """
    return with_preset(config, "preset", PRESETS, name)
