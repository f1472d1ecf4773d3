"""The experts that have a name: settings of the same stages."""

from dataclasses import replace
from typing import Any

from keypush.presets import with_preset
from keypush.scenario import Scenario

EXPERTS: dict[str, dict[str, Any]] = {
    "tuned": {},
    "thesis": {
        # The finger row lies in the plane of the push; a lower tool would press the palm's rear
        # end into the table.
        "wrist_yaw_deg": 0.0,
        "tool_height": 0.025,
        "approach_margin": 0.01,
        "touch_speed": 0.6,
        "lateral_gain": 0.0,
        "reapproach_error": 0.2,
        "wait_tilt_deg": 90.0,
        "reset_period": 20,
    },
}
"""Fields of `scenario.planner` that differ from their defaults, by the expert's name."""


def expert_scenario(scenario: Scenario, name: str) -> Scenario:
    """Returns the scenario with an expert's planner.

    Args:
        scenario: its planner's fields stay what they are where they differ from the defaults.
        name: one of `EXPERTS`.

    Raises:
        UserError: there is no such expert.
    """
    planner = with_preset(scenario.planner, "expert", EXPERTS, name)
    return replace(scenario, policy="expert", planner=planner)
