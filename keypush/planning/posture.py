"""Which way to hold the tool for a push: turned left or right, and how steeply."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RotationMatrix

from keypush.control.arm_kinematics import ArmKinematics
from keypush.control.differential_ik import damped_least_squares
from keypush.planning.push_frame import rotation_vector, tool_rotation

Array = NDArray[np.float64]

_ITERATIONS = 50
_DAMPING = 1e-3
_STEP = 0.4
"""Longest joint step of an iteration, rad."""
_MARGIN = 0.02
"""Distance kept from the joint limits, rad."""
REACHED = 0.002
"""Error below which a pose counts as reached, m (and rad, which weigh a tenth)."""
_TURN_WEIGHT = 0.1


@dataclass(frozen=True)
class Posture:
    """How the tool is held during a push."""

    side: int
    """+1: the finger row points to the left of the push; -1: to its right."""
    pitch: float
    """Angle of the tool's axis below the table plane, rad."""
    height: float
    """Height of the tool tip above the table over the point where it comes down, m."""


def choose_posture(
    arm: ArmKinematics,
    q: Array,
    d_W: Array,
    waypoints: Sequence[Array],
    candidates: Sequence[tuple[float, float]],
    wrist_yaw: float,
    sides: Sequence[int] = (1, -1),
    steps: Callable[[Posture], int | None] | None = None,
) -> tuple[Posture, float]:
    """Chooses the first pitch and height at which the arm reaches all, with the better side.

    The better side is the one with fewer steps, or without `steps` the one whose first waypoint is
    nearer in joint space. If the arm reaches nothing altogether, it is the posture with the least
    error; one in which it gets stuck counts as just out of reach.

    Args:
        arm: kinematics.
        q: (7,) joint positions to start from, rad.
        d_W: (3,) horizontal unit vector of the push.
        waypoints: (3,) positions of the tool in W: behind the contact, end of the push.
        candidates: pitches in rad and heights over the first waypoint to come down from in m, the
            preferred ones first.
        wrist_yaw: see `tool_rotation`, rad.
        sides: those to choose from.
        steps: tells how many steps a posture takes that the arm reaches; None where it gets stuck.

    Returns:
        The posture and what is left of its error, m (a tenth of it for rad); below `REACHED`
        where the arm reaches all and gets there.
    """
    best, least = Posture(sides[0], *candidates[0]), np.inf
    for pitch, height in candidates:
        above = np.array([waypoints[0][0], waypoints[0][1], height])
        reached = []
        for side in sides:
            posture = Posture(side, pitch, height)
            R_WE = tool_rotation(d_W, pitch, side, wrist_yaw)
            bound = max(least, REACHED)
            error, travel = _try_waypoints(arm, q, [above, *waypoints], R_WE, bound)
            way: float | None = travel
            if steps and error < REACHED:
                way = steps(posture)
                error = REACHED if way is None else error
            if error < REACHED and way is not None:
                reached.append((way, side, error))
            elif error < least:
                best, least = posture, error
        if reached:
            _, side, error = min(reached)
            return Posture(side, pitch, height), error
    return best, least


def _try_waypoints(
    arm: ArmKinematics, q: Array, waypoints: list[Array], R_WE: RotationMatrix, bound: float
) -> tuple[float, float]:
    """Returns the worst error over the waypoints and the joint travel to the first one.

    It gives up at the first error that is not below `bound`.
    """
    worst, travel, start = 0.0, 0.0, q
    for i, p_WE in enumerate(waypoints):
        q, error = solve_ik(arm, q, RigidTransform(R_WE, p_WE))
        worst = max(worst, error)
        if i == 0:
            travel = float(np.abs(q - start).max())
        if worst >= bound:
            break
    return worst, travel


def solve_ik(arm: ArmKinematics, q: Array, X_WE: RigidTransform) -> tuple[Array, float]:
    """Solves inverse kinematics from a start, by damped steps kept within the joint limits.

    Returns:
        Joint positions (7,) and what is left of the error, m (a tenth of it for rad).
    """
    lower, upper = arm.limits.lower + _MARGIN, arm.limits.upper - _MARGIN
    error = np.inf
    for _ in range(_ITERATIONS):
        X_WNow = arm.tool_pose(q)
        offset = X_WE.translation() - X_WNow.translation()
        turn = rotation_vector(X_WNow.rotation(), X_WE.rotation())
        error = float(np.linalg.norm(offset) + _TURN_WEIGHT * np.linalg.norm(turn))
        if error < REACHED / 2:
            break
        dq = damped_least_squares(arm.jacobian(q), np.concatenate([offset, turn]), _DAMPING)
        q = np.clip(q + dq * min(1.0, _STEP / np.abs(dq).max()), lower, upper)
    return q, error
