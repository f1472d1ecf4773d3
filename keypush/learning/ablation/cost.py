"""What an ablation costs, before it starts: seconds of one core."""

from collections.abc import Mapping

from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.pretraining.config import PretrainConfig
from keypush.networks.config import EncoderConfig

_SCENES: Mapping[tuple[int, int], float] = {
    (2, 32): 1500, (2, 16): 1050, (3, 32): 1150, (3, 16): 790,
}  # fmt: skip
"""Per second of pretraining, by layers and patch size; see docs/learning.md."""
_ROWS_ENCODED: Mapping[tuple[int, int], float] = {
    (2, 32): 5400, (2, 16): 3300, (3, 32): 4000, (3, 16): 2400,
}  # fmt: skip
"""Per second."""
_SECONDS_PER_STEP = 3e-3
"""Of a head, however few rows a step has."""
_SECONDS_PER_ROW = 11e-6
"""Of a head, beside that, however few tokens and heads it has."""
_SECONDS_PER_HEAD = 2.4e-6
"""And row."""
_SECONDS_PER_TOKEN = 0.55e-6
"""And row."""
_MEASURED = 8192 / 3
"""Rows after every epoch, in rows that are trained on: there are no gradients."""


def pretraining_seconds(config: PretrainConfig) -> float:
    """Of an encoder."""
    measured = config.validation_samples / 3
    scenes = config.epochs * (config.samples_per_epoch + measured)
    return scenes / _SCENES[config.encoder.layers, config.encoder.patch_size]


def encoding_seconds(rows: int, encoder: EncoderConfig) -> float:
    """Of a token cache."""
    return rows / _ROWS_ENCODED[encoder.layers, encoder.patch_size]


def head_seconds(rows: int, encoder: EncoderConfig, heads: int, config: ImitationConfig) -> float:
    """Of a training on so many rows."""
    per_row = (
        _SECONDS_PER_ROW + heads * _SECONDS_PER_HEAD + (encoder.patches + 1) * _SECONDS_PER_TOKEN
    )
    steps = -(-rows // config.batch)
    return config.epochs * (steps * _SECONDS_PER_STEP + (rows + _MEASURED) * per_row)
