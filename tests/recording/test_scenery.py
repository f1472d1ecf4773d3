"""Where the camera stands."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from keypush.recording.scenery import camera_position


@given(st.floats(-np.pi, np.pi), st.floats(0.1, 0.5))
def test_camera_is_never_behind_the_hand_nor_behind_the_robot(angle: float, length: float) -> None:
    push = length * np.array([np.cos(angle), np.sin(angle)])
    p_WC = camera_position(push)
    assert p_WC[0] > -0.5
    assert p_WC[2] > 0.5
    # A push straight at the robot is seen from the side.
    assert (p_WC[:2] - [-0.17, 0.0]) @ push >= -1e-6
