"""Experts by name are settings of one scenario."""

from dataclasses import replace

import pytest

from keypush.errors import UserError
from keypush.planning.presets import EXPERTS, expert_scenario
from keypush.scenario import PlannerConfig, Scenario, parse_scenario


@pytest.mark.parametrize("name", EXPERTS)
def test_an_experts_fields_are_valid_and_differ_from_the_defaults(name: str) -> None:
    scenario = expert_scenario(Scenario(), name)
    scenario.validate()
    assert scenario.policy == "expert"
    for field, value in EXPERTS[name].items():
        assert getattr(scenario.planner, field) == value
        assert getattr(PlannerConfig(), field) != value


def test_the_tuned_expert_is_the_default() -> None:
    assert expert_scenario(Scenario(), "tuned").planner == PlannerConfig()


def test_what_the_user_sets_stays() -> None:
    plain = Scenario()
    mine = replace(plain, planner=replace(plain.planner, reset_period=7, push_speed=0.1))
    planner = expert_scenario(mine, "thesis").planner
    assert (planner.reset_period, planner.push_speed) == (7, 0.1)
    assert planner.wrist_yaw_deg == 0.0


def test_a_field_at_its_default_counts_as_not_given() -> None:
    mine = parse_scenario("planner: {reset_period: 0, wrist_yaw_deg: 90}")
    planner = expert_scenario(mine, "thesis").planner
    assert (planner.reset_period, planner.wrist_yaw_deg) == (20, 0.0)


def test_an_unknown_expert_is_the_users_mistake() -> None:
    with pytest.raises(UserError, match=r"^expert is 'best'; allowed: tuned, thesis$"):
        expert_scenario(Scenario(), "best")
