"""The grid of conditions."""

import math
from dataclasses import replace

import pytest

from keypush.errors import UserError
from keypush.evaluation.conditions import condition_name, grid
from keypush.scenario import Scenario


def test_every_combination_is_a_condition() -> None:
    found = grid(Scenario(), {"sizes": [0.75, 1], "com-shifts": [0, 0.015]})
    values = [(s.object.size_ratio, s.variation.com_shift, s.noise.cloud_deviation) for s in found]
    assert values == [(0.75, 0, 0.005), (0.75, 0.015, 0.005), (1, 0, 0.005), (1, 0.015, 0.005)]
    assert [condition_name(s) for s in found] == [
        "size_0.75-shift_0-noise_0.005",
        "size_0.75-shift_0.015-noise_0.005",
        "size_1-shift_0-noise_0.005",
        "size_1-shift_0.015-noise_0.005",
    ]


def test_without_values_the_scenario_stays() -> None:
    scenario = Scenario(seed=5)
    scenario = replace(scenario, object=replace(scenario.object, size_ratio=1.3))
    assert grid(scenario, {"sizes": ()}) == [scenario]


def test_minus_zero_is_zero() -> None:
    (found,) = grid(Scenario(), {"com-shifts": [-0.0]})
    assert condition_name(found) == condition_name(Scenario())
    assert math.copysign(1, found.variation.com_shift) == 1
    given = replace(Scenario(), variation=replace(Scenario().variation, com_shift=-0.0))
    assert condition_name(given) == condition_name(Scenario())


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"sizes": [1, 9]}, r"^--sizes: object\.size_ratio is 9\.0; allowed: 0\.25 to 3$"),
        ({"com-shifts": [-0.01]}, r"^--com-shifts: variation\.com_shift is -0\.01"),
        ({"cloud-noise": [float("nan")]}, r"^--cloud-noise: noise\.cloud_deviation is nan"),
        ({"sizes": [1, 0.75, 1.0]}, "^--sizes has 1 twice; allowed: each value once$"),
        ({"com-shifts": [0, -0.0]}, "^--com-shifts has 0 twice"),
    ],
)
def test_what_is_out_of_range_or_twice_is_named(values: dict[str, list[float]], words: str) -> None:
    with pytest.raises(UserError, match=words):
        grid(Scenario(), values)
