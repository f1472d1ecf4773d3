"""Where the camera stands, and what the robot stands on."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from keypush.recording.recorder import make_meshcat
from keypush.recording.scenery import add_scenery, camera_position
from keypush.scenario import parse_scenario


@given(st.floats(-np.pi, np.pi), st.floats(0.1, 0.5))
def test_camera_is_never_behind_the_hand_nor_behind_the_robot(angle: float, length: float) -> None:
    push = length * np.array([np.cos(angle), np.sin(angle)])
    p_WC = camera_position(push)
    assert p_WC[0] > -0.5
    assert p_WC[2] > 0.5
    # A push straight at the robot is seen from the side.
    assert (p_WC[:2] - [-0.17, 0.0]) @ push >= -1e-6


@pytest.mark.parametrize(
    ("height", "base", "stands_on_it"),
    [(0.4, 0.0, True), (0.1, -0.1, False), (0.1, -0.3, False), (0.1, -0.09, True)],
)
def test_a_pedestal_is_drawn_where_the_robot_stands_above_the_floor(
    height: float, base: float, stands_on_it: bool
) -> None:
    scenario = parse_scenario(
        f"{{table: {{height: {height}}}, robot: {{base_position: [-0.5, 0, {base}]}}}}"
    )
    meshcat = make_meshcat()
    add_scenery(meshcat, scenario, np.zeros(2), np.array([0.1, 0.0]))
    assert meshcat.HasPath("/scenery/pedestal") == stands_on_it
    assert meshcat.HasPath("/scenery/floor")
