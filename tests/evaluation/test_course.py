"""The story of an episode, from rows whose story is known."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from keypush.evaluation.course import tell_course, tilt_deg
from keypush.planning.plan_state import Stage

NAN3 = [math.nan] * 3
Rows = dict[str, NDArray[Any]]


def _rows(stages: list[Stage], contacts: list[list[float]]) -> Rows:
    """The object goes 1 cm along x in each step; the goal is 30 cm ahead of its start."""
    count = len(stages)
    x = 0.01 * np.arange(count)
    poses = np.zeros((count, 7))
    poses[:, 0] = 1.0
    poses[:, 4] = x
    com = np.column_stack([x, np.zeros(count), np.full(count, 0.03)])
    return {
        "stage": np.array(stages),
        "object_pose": poses,
        "tool_pose": poses,
        "com": com,
        "goal": np.tile([0.3, 0.0], (count, 1)),
        "contact_point": np.array(contacts),
        "target": np.full((count, 3), np.nan),
    }


def _told(rows: Rows, outcome: str, steps: int | None = None) -> str:
    last = len(rows["stage"]) - 1 if steps is None else steps
    return tell_course({"success": outcome == "success", "outcome": outcome, "steps": last}, rows)


def _turn(poses: NDArray[np.float64], axis: list[float], degrees: float) -> None:
    """Turns the last pose."""
    half = math.radians(degrees) / 2
    poses[-1, :4] = [math.cos(half), *(math.sin(half) * np.array(axis))]


def test_contacts_that_flicker_are_one_and_a_retreat_is_told() -> None:
    touch = [0.0, 0.012, 0.021]
    contacts = [NAN3, touch, NAN3, touch, NAN3, NAN3, NAN3, NAN3, touch, touch]
    stages = [Stage.SETTLE, *[Stage.PUSH] * 3, Stage.RETREAT, Stage.DESCEND, *[Stage.PUSH] * 4]
    told = _told(_rows(stages, contacts), "success")
    assert told == (
        "First touched 1.2 cm left of the centre of mass, 2.1 cm high; pushed 9 cm; 2 contacts; "
        "re-approached once"
    )


def test_what_comes_after_the_outcome_is_no_contact_and_no_new_approach() -> None:
    contacts = [NAN3, [0.0, -0.002, 0.02], *[NAN3] * 6, [0.0, 0.0, 0.0]]
    stages = [Stage.SETTLE, Stage.PUSH, *[Stage.HALTED] * 7]
    told = _told(_rows(stages, contacts), "success", steps=2)
    assert "in line with the centre of mass" in told
    assert "1 contact" in told
    assert "re-approached" not in told


@pytest.mark.parametrize(("times", "word"), [(1, "once"), (2, "twice"), (3, "3 times")])
def test_new_approaches_are_counted_also_without_a_touch(times: int, word: str) -> None:
    stages = [Stage.RISE, *[Stage.APPROACH, Stage.RISE] * times]
    told = _told(_rows(stages, [NAN3] * len(stages)), "timed_out")
    assert told == f"Never touched; re-approached {word}"


def test_who_misses_is_told_how_near_the_object_came() -> None:
    rows = _rows([Stage.PUSH] * 35, [[0.0, -0.01, 0.02]] * 35)
    rows["goal"][:, 1] = 0.08
    assert "came within 8.0 cm of the goal" in _told(rows, "timed_out")
    assert "came within" not in _told(rows, "timed_out", steps=30)
    assert "came within" not in _told(rows, "success")


@pytest.mark.parametrize(("degrees", "word"), [(40.0, "40° to the left"), (-40.0, "40° to the")])
def test_turns_about_the_vertical_are_told_with_their_side(degrees: float, word: str) -> None:
    rows = _rows([Stage.PUSH] * 3, [[0.0, -0.01, 0.02]] * 3)
    _turn(rows["object_pose"], [0.0, 0.0, 1.0], degrees)
    told = _told(rows, "success")
    assert "1.0 cm right" in told
    assert f"turned {word}" in told
    assert ("left" in told) == (degrees > 0)


def test_who_topples_is_told_tilt_and_last_touch() -> None:
    rows = _rows([Stage.PUSH] * 3, [[0.0, 0.02, 0.09], [0.0, 0.03, 0.08], NAN3])
    _turn(rows["object_pose"], [0.6, 0.8, 0.0], 52.0)
    told = _told(rows, "toppled")
    assert told.endswith(
        "last touched 3.0 cm left of the centre of mass, 8.0 cm high; tilted by 52° at the end"
    )


def test_tilt_is_against_the_first_pose_and_knows_no_turn() -> None:
    poses = np.zeros((2, 7))
    poses[:, 0] = 1.0
    _turn(poses, [0.0, 0.0, 1.0], 80.0)
    assert tilt_deg(poses) == pytest.approx([0.0, 0.0], abs=1e-5)
    _turn(poses, [1.0, 0.0, 0.0], 30.0)
    assert tilt_deg(poses) == pytest.approx([0.0, 30.0], abs=1e-5)
    assert tilt_deg(poses[::-1])[1] == pytest.approx(30.0, abs=1e-5)
