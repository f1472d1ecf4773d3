"""The tool's orientation is a proper rotation for every push, and turns take the short way."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import AngleAxis, Quaternion
from pydrake.math import RotationMatrix

from keypush.planning.push_frame import left_of, push_direction, rotation_vector, tool_rotation
from keypush.scenario import PlannerConfig

UP = np.array([0.0, 0.0, 1.0])
headings = st.floats(-np.pi, np.pi).map(lambda a: np.array([np.cos(a), np.sin(a), 0.0]))
pitches = st.floats(0.0, np.pi / 2)
sides = st.sampled_from([1, -1])
rotations = (
    st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4)
    .filter(lambda w: np.linalg.norm(w) > 1e-3)
    .map(lambda w: RotationMatrix(Quaternion(np.array(w) / np.linalg.norm(w))))
)


@given(headings, pitches, sides, st.floats(0.0, np.pi / 2))
def test_the_tools_frame_is_a_proper_rotation(
    d_W: NDArray[np.float64], pitch: float, side: int, wrist_yaw: float
) -> None:
    R = tool_rotation(d_W, pitch, side, wrist_yaw).matrix()
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    assert np.isclose(np.linalg.det(R), 1.0, atol=1e-12)


@given(headings, pitches, sides)
def test_the_tool_faces_the_push_and_its_fingers_lie_across(
    d_W: NDArray[np.float64], pitch: float, side: int
) -> None:
    x_axis, y_axis, z_axis = tool_rotation(d_W, pitch, side).matrix().T
    np.testing.assert_allclose(y_axis, side * np.cross(UP, d_W), atol=1e-12)
    # The angle between the tool's axis and the table plane, downwards.
    assert np.isclose(np.arctan2(-z_axis @ UP, z_axis @ d_W), pitch, atol=1e-12)
    assert np.isclose(z_axis @ left_of(d_W), 0.0, atol=1e-12)
    assert np.isclose(x_axis @ left_of(d_W), 0.0, atol=1e-12)


@given(headings, pitches, st.floats(0.0, np.pi / 2))
def test_the_wrist_turns_the_finger_row_out_of_the_plane_of_the_push(
    d_W: NDArray[np.float64], pitch: float, wrist_yaw: float
) -> None:
    R = tool_rotation(d_W, pitch, 1, wrist_yaw).matrix()
    across = np.cross(UP, d_W)
    assert np.isclose(R[:, 1] @ across, np.sin(wrist_yaw), atol=1e-12)
    np.testing.assert_allclose(R[:, 2], tool_rotation(d_W, pitch, 1).matrix()[:, 2], atol=1e-12)
    # The other side is half a turn about the tool's axis away.
    other = tool_rotation(d_W, pitch, -1, wrist_yaw).matrix()
    np.testing.assert_allclose(other, R * [-1.0, -1.0, 1.0], atol=1e-12)


def test_the_default_pitch_is_60_degrees_below_the_table_plane() -> None:
    pitch = np.deg2rad(PlannerConfig().pitch_deg)
    R = tool_rotation(np.array([1.0, 0.0, 0.0]), pitch, 1).matrix()
    np.testing.assert_allclose(R[:, 2], [0.5, 0.0, -np.sqrt(3) / 2], atol=1e-12)
    np.testing.assert_allclose(R[:, 1], [0.0, 1.0, 0.0], atol=1e-12)


def _exp(vector: NDArray[np.float64]) -> RotationMatrix:
    angle = float(np.linalg.norm(vector))
    return RotationMatrix(AngleAxis(angle, vector / angle)) if angle > 0 else RotationMatrix()


@given(rotations, rotations)
def test_the_rotation_vector_turns_one_into_the_other(
    R_WA: RotationMatrix, R_WB: RotationMatrix
) -> None:
    vector = rotation_vector(R_WA, R_WB)
    assert np.linalg.norm(vector) <= np.pi + 1e-9
    turned = _exp(vector) @ R_WA
    np.testing.assert_allclose(turned.matrix(), R_WB.matrix(), atol=1e-9)


@given(rotations, headings, st.floats(0.0, np.pi - 1e-3))
def test_a_known_turn_is_found(
    R_WA: RotationMatrix, axis: NDArray[np.float64], angle: float
) -> None:
    vector = rotation_vector(R_WA, _exp(angle * axis) @ R_WA)
    np.testing.assert_allclose(vector, angle * axis, atol=1e-6)


points = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3).map(np.array)


@given(points, points)
def test_the_push_points_horizontally_at_the_goal(
    p_W: NDArray[np.float64], goal_W: NDArray[np.float64]
) -> None:
    d_W = push_direction(p_W, goal_W[:2])
    assert d_W[2] == 0.0
    assert np.isclose(np.linalg.norm(d_W), 1.0)
    offset = goal_W[:2] - p_W[:2]
    length = np.linalg.norm(offset)
    if length > 1e-6:
        np.testing.assert_allclose(length * d_W[:2], offset, atol=1e-12)
    np.testing.assert_array_equal(push_direction(p_W[:2], goal_W[:2]), d_W)


def test_at_the_goal_any_direction_will_do() -> None:
    d_W = push_direction(np.zeros(3), np.zeros(2))
    assert np.isclose(np.linalg.norm(d_W), 1.0)
    assert d_W[2] == 0.0


@given(headings)
def test_left_is_a_quarter_turn(d_W: NDArray[np.float64]) -> None:
    np.testing.assert_allclose(left_of(d_W), np.cross(UP, d_W), atol=1e-15)
