"""What is measured of an episode's rows, against figures computed by hand."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from keypush.evaluation.measures import measure_rows
from keypush.planning.plan_state import Stage

NAN3 = [math.nan] * 3


def _poses(points: list[list[float]]) -> NDArray[np.float64]:
    return np.array([[1.0, 0.0, 0.0, 0.0, *point] for point in points])


def _rows() -> dict[str, NDArray[Any]]:
    return {
        "stage": np.array([Stage.APPROACH, Stage.PUSH, Stage.PUSH, Stage.PUSH, Stage.HALTED]),
        # 3, 4 and 5 cm sides; the step in z does not count.
        "object_pose": _poses([[0, 0, 0], [0, 0, 0.1], [0.03, 0, 0], [0.03, 0.04, 0], [0, 0, 0]]),
        "tool_pose": _poses([[0, 0, 0.2], [0, 0, 0], [0, 0, 0], [0.1, 0, 0], [0.1, 0, 0]]),
        "goal": np.array([[0.1, -0.2]] * 5),
        # Of the pushing steps one touches nothing; contacts of other stages do not count.
        "contact_point": np.array(
            [[9.0, 9.0, 9.0], [0.01, 0, 0], NAN3, [0.03, 0.0, 0.04], [9.0, 9.0, 9.0]]
        ),
        "target": np.zeros((5, 3)),
    }


def test_paths_start_goal_and_keypoint_error() -> None:
    measured = measure_rows(_rows())
    assert math.isclose(measured["object_path"], 0.03 + 0.04 + 0.05)
    assert math.isclose(measured["tool_path"], 0.2 + 0.1)
    assert math.isclose(measured["keypoint_error"], (0.01 + 0.05) / 2)
    assert (measured["start_x"], measured["start_y"]) == (0.0, 0.0)
    assert (measured["goal_x"], measured["goal_y"]) == (0.1, -0.2)


def test_without_a_keypoint_or_a_contact_there_is_no_error() -> None:
    for column in ("target", "contact_point"):
        rows = _rows()
        rows[column] = np.array([NAN3] * 5)
        assert math.isnan(measure_rows(rows)["keypoint_error"])
