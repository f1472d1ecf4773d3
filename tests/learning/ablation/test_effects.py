"""Effects, intervals and orders of errors that are given by a formula."""

import numpy as np
import pytest
from scipy import stats

from keypush.learning.ablation.effects import (
    find_effects,
    order_beside_thesis,
    order_between_seeds,
    ranked,
)
from keypush.learning.ablation.settings import SETTINGS, Setting
from tests.learning.ablation.sample import made_up


def _additive(setting: Setting, seed: int) -> float:
    error = 0.05 + 1e-4 * seed
    error -= 0.01 * setting.use_com
    error += (0.002 if setting.use_com else -0.003) * (setting.shape.layers == 3)
    error += 0.004 * (setting.shape.patch_size == 16)
    return error + 0.001 * (setting.heads == 16) * (1 if setting.shape.layers == 2 else -3)


def test_effects_of_a_sum_are_its_terms() -> None:
    found = {effect.what: effect for effect in find_effects(made_up(_additive))}
    wanted = {
        "told the centre of mass": -0.01 + (0.002 + 0.003) / 2,
        "with it: 3 layers": 0.002 - 0.002,
        "with it: patches of 16": 0.004,
        "with it: 16 heads": -0.001,
        "with it: 16 heads at 2 layers": 0.001,
        "with it: 16 heads at 3 layers": -0.003,
        "without it: 3 layers": -0.003 - 0.002,
    }
    for what, value in wanted.items():
        assert found[what].mean == pytest.approx(value, abs=1e-12), what
        assert found[what].interval == pytest.approx((value, value), abs=1e-9), what
    assert len(found) == 11


def test_effects_of_the_thesis_are_those_of_its_tables() -> None:
    found = {effect.what: effect.thesis for effect in find_effects(made_up(_additive))}
    assert found["with it: patches of 16"] == pytest.approx(
        (0.0838 + 0.1017 + 0.1052 + 0.0821 - 0.1034 - 0.1494 - 0.1185 - 0.0960) / 4
    )
    assert found["without it: 16 heads at 3 layers"] == pytest.approx(
        (0.4241 + 0.2854 - 0.3065 - 0.3566) / 2
    )


@pytest.mark.parametrize("size", [0.0, 0.02])
def test_the_interval_is_students_over_the_seeds(size: float) -> None:
    rng = np.random.default_rng(1)
    seeds = (0, 1, 2, 3)
    noise = {(s, seed): rng.normal(0, 0.002) for s in SETTINGS for seed in seeds}
    ablation = made_up(lambda s, seed: 0.05 + size * s.use_com + noise[s, seed], seeds)
    effect = find_effects(ablation)[0]
    changes = [
        np.mean([ablation.errors(s)[k] for s in SETTINGS if s.use_com])
        - np.mean([ablation.errors(s)[k] for s in SETTINGS if not s.use_com])
        for k in range(len(seeds))
    ]
    wanted = stats.ttest_1samp(changes, 0).confidence_interval(0.95)
    assert effect.interval == pytest.approx((wanted.low, wanted.high))
    assert effect.is_told_from_zero == (wanted.low > 0 or wanted.high < 0) == (size > 0)


def test_one_seed_has_no_interval() -> None:
    ablation = made_up(_additive, (5,))
    assert all(effect.interval is None for effect in find_effects(ablation))
    assert not any(effect.is_told_from_zero for effect in find_effects(ablation))
    assert order_between_seeds(ablation, use_com=True) is None


@pytest.mark.parametrize("use_com", [True, False])
def test_orders_are_compared_by_rank(use_com: bool) -> None:
    like = made_up(lambda s, _: 0.1 * s.thesis_error**2)
    unlike = made_up(lambda s, seed: (-1) ** (seed + 1) * s.thesis_error + 1, (0, 1))
    assert order_beside_thesis(like, use_com=use_com) == pytest.approx(1)
    assert order_between_seeds(like, use_com=use_com) == pytest.approx(1)
    assert order_between_seeds(unlike, use_com=use_com) == pytest.approx(-1)
    errors = [s.thesis_error for s in ranked(like, use_com=use_com)]
    assert errors == sorted(errors)
    assert len(errors) == 8
