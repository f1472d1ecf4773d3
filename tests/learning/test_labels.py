import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from keypush.dataset.arrays import to_array
from keypush.dataset.check import check_dataset
from keypush.dataset.poses import rotations
from keypush.dataset.read import open_dataset
from keypush.learning.labels import make_labels
from keypush.learning.rows import Rows, read_rows
from keypush.learning.scenes import scene_table
from keypush.planning.plan_state import Stage

APPROACH, PUSH, RETREAT, HALTED = 1, 4, 5, 6
NONE = [np.nan] * 3


def _pose(yaw: float, x: float) -> list[float]:
    return [np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2), x, 0.0, 0.05]


def _rows(
    stages: list[int],
    contacts: list[list[float]],
    poses: list[list[float]] | None = None,
    episodes: list[int] | None = None,
) -> Rows:
    n = len(stages)
    zeros: NDArray[np.float64] = np.zeros((n, 3))
    return Rows(
        objects=[("block", 1.0)],
        seeds=[0],
        object_index=np.zeros(n, dtype=np.int64),
        episode=np.array(episodes or [0] * n),
        stage=np.array(stages),
        object_pose=np.array(poses or [_pose(0.0, 0.0)] * n),
        com=zeros,
        goal=zeros[:, :2],
        tool_pose=np.array([_pose(0.0, 0.0)] * n),
        contact_point=np.array(contacts, dtype=float),
        target=zeros + 0.5,
        action=np.zeros((n, 6)),
    )


def test_push_with_contact_has_its_own_contact() -> None:
    rows = _rows([PUSH, PUSH], [[0.1, 0.0, 0.01], [0.2, 0.0, 0.01]])
    np.testing.assert_allclose(make_labels(rows, "measured"), rows.contact_point, atol=1e-12)


def test_other_rows_have_the_next_contact_carried_on_the_object() -> None:
    # The object is touched at its -x side, 3 cm from Oo, after it has moved and turned.
    poses = [_pose(0.0, 0.0), _pose(0.0, 0.0), _pose(np.pi / 2, 0.1)]
    rows = _rows([APPROACH, PUSH, PUSH], [NONE, NONE, [0.1, -0.03, 0.01]], poses)
    expected = [[-0.03, 0.0, 0.01], [-0.03, 0.0, 0.01], [0.1, -0.03, 0.01]]
    np.testing.assert_allclose(make_labels(rows, "measured"), expected, atol=1e-12)


def test_retreat_belongs_to_the_coming_push() -> None:
    stages = [PUSH, RETREAT, APPROACH, PUSH]
    first, second = [0.1, 0.0, 0.01], [0.3, 0.0, 0.01]
    # What is touched while retreating is no push.
    labels = make_labels(_rows(stages, [first, [9.0, 9.0, 9.0], NONE, second]), "measured")
    np.testing.assert_allclose(labels, [first, second, second, second], atol=1e-12)


def test_rows_without_a_coming_contact_have_no_label() -> None:
    contact = [0.1, 0.0, 0.01]
    stages = [PUSH, RETREAT, APPROACH, PUSH]
    labels = make_labels(
        _rows(stages, [contact, NONE, NONE, contact], None, [0, 0, 1, 1]), "measured"
    )
    np.testing.assert_array_equal(np.isfinite(labels[:, 0]), [True, False, True, True])


@pytest.mark.parametrize("label", ["measured", "analytic"])
def test_halted_rows_have_no_label(label: str) -> None:
    rows = _rows([PUSH, HALTED, PUSH, PUSH], [[0.1, 0.0, 0.01]] * 4)
    missing = np.isnan(make_labels(rows, label)).all(axis=1)
    np.testing.assert_array_equal(missing[:3], [False, True, False])
    assert np.isfinite(rows.target).all()


def test_analytic_label_is_the_rows_target() -> None:
    rows = _rows([APPROACH] * 4, [NONE] * 4, None, [0, 0, 0, 1])
    rows.target[:] = np.arange(12.0).reshape(4, 3)
    np.testing.assert_array_equal(make_labels(rows, "analytic"), rows.target)


@pytest.mark.slow
def test_labels_of_collected_episodes(tmp_path: Path) -> None:
    run = "from keypush.cli.main import main; raise SystemExit(main())"
    command = [sys.executable, "-c", run, "collect", "--objects", "can"]
    command += ["--episodes-per-object", "2", "--workers", "1", "--out", str(tmp_path / "data")]
    subprocess.run(command, check=True)
    rows = read_rows(tmp_path / "data", keep_failures=True)
    table = scene_table(rows, make_labels(rows, "analytic"))
    pushing = torch.from_numpy(rows.stage == PUSH) & table.label.isfinite().all(dim=1)
    # The line of push through the COM of the row's own pose, and the can's radius behind it.
    along, across = table.label[pushing, 0], table.label[pushing, 1]
    assert across.abs().median() < 5e-4
    assert (along - along.median()).abs().median() < 5e-4
    dataset = open_dataset(tmp_path / "data")
    stored = to_array(dataset.read(["keypoint"])["keypoint"])
    measured = make_labels(rows, "measured")
    assert np.isfinite(stored).all(axis=1).mean() > 0.5
    np.testing.assert_allclose(measured, stored, atol=1e-6)  # where NaN, there NaN
    assert all(check.ok for check in check_dataset(dataset).values())


def test_rotations_read_the_scalar_first() -> None:
    pose = np.array([_pose(0.3, 0.0)])
    np.testing.assert_allclose(rotations(pose)[0], Rotation.from_euler("z", 0.3).as_matrix())


def test_stages_are_the_planners() -> None:
    assert (Stage.PUSH, Stage.HALTED) == (PUSH, HALTED)
