"""The 16 settings, and what is refused of an ablation's configuration."""

import dataclasses
from typing import Any

import pytest

from keypush.errors import UserError
from keypush.learning.ablation.config import AblationConfig, AblationHead
from keypush.learning.ablation.settings import SETTINGS, SHOWN
from keypush.learning.pretraining.config import PretrainConfig
from keypush.networks.config import EncoderConfig
from tests.learning.ablation.sample import HELD_OUT

THESIS = {
    (2, 32, 8): (0.1034, 0.1585), (2, 32, 16): (0.1494, 0.1375), (2, 16, 8): (0.0838, 0.4317),
    (2, 16, 16): (0.1017, 0.2522), (3, 32, 8): (0.1185, 0.3065), (3, 32, 16): (0.0960, 0.4241),
    (3, 16, 8): (0.1052, 0.3566), (3, 16, 16): (0.0821, 0.2854),
}  # fmt: skip
"""Validation errors with and without the centre of mass: tables 5.3 and 5.4."""


def test_every_setting_has_its_own_figure_of_the_thesis() -> None:
    found = {
        (s.shape.layers, s.shape.patch_size, s.heads, s.use_com): s.thesis_error for s in SETTINGS
    }
    wanted = {
        (*sizes, use_com): errors[not use_com]
        for sizes, errors in THESIS.items()
        for use_com in (True, False)
    }
    assert found == wanted
    assert [s.model for s in SETTINGS] == 2 * list(range(1, 9))
    assert len({s.name for s in SETTINGS}) == 16


def test_shown_are_the_best_of_the_thesis() -> None:
    for shown in SHOWN:
        half = [s for s in SETTINGS if s.use_com == shown.use_com]
        assert shown == min(half, key=lambda s: s.thesis_error)


def test_a_setting_decides_the_sizes_and_a_seed_the_head_alone() -> None:
    config = AblationConfig(head=AblationHead(seed=7))
    assert tuple(config.held_out) == HELD_OUT
    for setting in SETTINGS:
        head, encoder = config.of_head(setting, 2), config.of_encoder(setting.shape)
        assert (head.seed, head.heads, head.use_com) == (2, setting.heads, setting.use_com)
        assert (encoder.seed, encoder.encoder.layers) == (0, setting.shape.layers)
        assert encoder.encoder.patch_size == setting.shape.patch_size
        assert head.held_out_objects == encoder.held_out_objects == config.held_out
    assert config.rows.seed == 7


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seeds": ()}, "seeds is empty; allowed: whole numbers"),
        ({"seeds": (1, 1)}, "seeds is 1 1; allowed"),
        ({"seeds": (-1,)}, "seeds is -1; allowed"),
        ({"seeds": (0, 2**64)}, "seeds is 0 18446744073709551616; allowed: .* to 9007199254740992"),
        ({"head": AblationHead(heads=16)}, r"head\.heads is 16; allowed: 8, because"),
        ({"head": AblationHead(use_com=False)}, r"head\.use_com is False; allowed: True"),
        ({"head": AblationHead(cache=False)}, r"head\.cache is False; allowed: True"),
        ({"head": AblationHead(patience=3)}, r"head\.patience is 3; allowed: 0"),
        ({"head": AblationHead(batch=0)}, r"batch is 0; allowed: 1 to"),
        (
            {"head": AblationHead(held_out_objects=["mug"])},
            r"head\.held_out_objects is \['mug'\]; allowed: \[\]",
        ),
        (
            {"pretraining": PretrainConfig(encoder=EncoderConfig(layers=3))},
            r"pretraining\.encoder\.layers is 3; allowed: 2",
        ),
        ({"pretraining": PretrainConfig(epochs=0)}, r"epochs is 0; allowed: 1 to"),
    ],
)  # fmt: skip
def test_settings_that_would_spoil_the_comparison_are_named(
    change: dict[str, Any], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        dataclasses.replace(AblationConfig(), **change).validate()
