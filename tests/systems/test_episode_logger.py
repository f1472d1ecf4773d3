"""EpisodeLogger: the row's layout is that of ROW_COLUMNS."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from keypush.objects.point_cloud import pose_to_vector
from keypush.systems.episode_logger import ROW_COLUMNS, ROW_SIZE, EpisodeLogger
from tests.systems.contract import assert_pure, evaluate, ports

VECTORS = {
    "stage": 1,
    "object_com": 3,
    "goal": 2,
    "tool_action": 6,
    "arm_state": 14,
    "contact": 6,
    "contact_target": 3,
}
WXYZ = np.array([0.5, -0.5, 0.5, 0.5])
P_WO, P_WE = np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.5, 0.6])


def _logger() -> tuple[EpisodeLogger, Context, dict[str, NDArray[np.float64]]]:
    logger = EpisodeLogger()
    context = logger.CreateDefaultContext()
    rng = np.random.default_rng(0)
    values = {name: rng.normal(size=size) for name, size in VECTORS.items()}
    for name, value in values.items():
        logger.GetInputPort(name).FixValue(context, value)
    pose = RigidTransform(Quaternion(WXYZ), P_WO)
    logger.GetInputPort("object_pose").FixValue(context, pose)
    logger.GetInputPort("tool_pose").FixValue(context, RigidTransform(P_WE))
    return logger, context, values


def test_ports() -> None:
    poses: dict[str, int | None] = {"object_pose": None, "tool_pose": None}
    assert ports(EpisodeLogger()) == {"in": {**VECTORS, **poses}, "out": {"row": ROW_SIZE}}


def test_outputs_are_pure() -> None:
    logger, context, _ = _logger()
    assert_pure(logger, context)


def test_every_number_stands_in_its_column() -> None:
    logger, context, values = _logger()
    row = np.array(evaluate(logger, "row", context))
    ends = np.cumsum(list(ROW_COLUMNS.values()))
    columns = dict(zip(ROW_COLUMNS, np.split(row, ends[:-1]), strict=True))
    expected: dict[str, Any] = {
        "stage": values["stage"],
        "object_pose": [*WXYZ, *P_WO],
        "com": values["object_com"],
        "goal": values["goal"],
        "tool_pose": [1, 0, 0, 0, *P_WE],
        "action": values["tool_action"],
        "q": values["arm_state"][:7],
        "v": values["arm_state"][7:],
        "contact_point": values["contact"][:3],
        "contact_force": values["contact"][3:],
        "target": values["contact_target"],
    }
    assert list(expected) == list(ROW_COLUMNS)
    for name, value in expected.items():
        np.testing.assert_allclose(columns[name], value, atol=1e-15, err_msg=name)


quaternions = (
    st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4)
    .filter(lambda w: np.linalg.norm(w) > 1e-3)
    .map(lambda w: np.array(w) / np.linalg.norm(w))
)


@given(quaternions)
def test_a_pose_has_one_quaternion_with_w_not_negative(wxyz: NDArray[np.float64]) -> None:
    X = RigidTransform(Quaternion(wxyz), P_WO)
    row = pose_to_vector(X)
    assert row[0] >= 0
    np.testing.assert_allclose(row[4:], P_WO)
    again = RigidTransform(Quaternion(row[:4]), row[4:])
    np.testing.assert_allclose(again.GetAsMatrix4(), X.GetAsMatrix4(), atol=1e-12)
