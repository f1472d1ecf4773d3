"""Which way to hold the tool for a push: turned left or right, and how steeply."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import AngleAxis
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
_WAY_STEP = 0.03
"""Of a way that is followed, m."""
_WAY_TURN = 0.06
"""Turn in a step of it, rad."""
_WAY_ITERATIONS, _END_ITERATIONS = 2, 20
"""At every step of the way, and at its end."""

InverseKinematics = Callable[[ArmKinematics, Array, RigidTransform], tuple[Array, float]]
"""`solve_ik` or `follow_ik`."""


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
    pitches: Sequence[float],
    heights: Sequence[float],
    wrist_yaw: float,
    sides: Sequence[int] = (1, -1),
    *,
    solve: InverseKinematics,
) -> tuple[Posture, float]:
    """Chooses the first pitch and height at which the arm reaches all, with the better side.

    The better side is the one whose first waypoint is nearer in joint space. If the arm
    reaches nothing altogether, it is the posture with the least error.

    Args:
        arm: kinematics.
        q: (7,) joint positions to start from, rad.
        d_W: (3,) horizontal unit vector of the push.
        waypoints: (3,) positions of the tool in W: behind the contact, end of the push.
        pitches: angles to try, the preferred one first, rad.
        heights: heights over the first waypoint to come down from, likewise, m.
        wrist_yaw: see `tool_rotation`, rad.
        sides: those to choose from.
        solve: how to find joint positions for a waypoint from those of the last one.

    Returns:
        The posture and what is left of its error, m (a tenth of it for rad); below `REACHED`
        where the arm reaches all.
    """
    best, least = Posture(sides[0], pitches[0], heights[0]), np.inf
    for pitch in pitches:
        for height in heights:
            above = np.array([waypoints[0][0], waypoints[0][1], height])
            reached = []
            for side in sides:
                R_WE = tool_rotation(d_W, pitch, side, wrist_yaw)
                X_WEs = [RigidTransform(R_WE, p_WE) for p_WE in (above, *waypoints)]
                bound = max(least, REACHED)
                error, travel = _try_waypoints(arm, q, X_WEs, bound, solve)
                if error < REACHED:
                    reached.append((travel, side, error))
                elif error < least:
                    best, least = Posture(side, pitch, height), error
            if reached:
                _, side, error = min(reached)
                return Posture(side, pitch, height), error
    return best, least


def _try_waypoints(
    arm: ArmKinematics,
    q: Array,
    waypoints: Sequence[RigidTransform],
    bound: float,
    solve: InverseKinematics,
) -> tuple[float, float]:
    """Returns the worst error over the waypoints and the joint travel to the first one.

    It gives up at the first error that is not below `bound`.
    """
    worst, travel, start = 0.0, 0.0, q
    for i, X_WE in enumerate(waypoints):
        q, error = solve(arm, q, X_WE)
        worst = max(worst, error)
        if i == 0:
            travel = float(np.abs(q - start).max())
        if worst >= bound:
            break
    return worst, travel


def follow_ik(arm: ArmKinematics, q: Array, X_WE: RigidTransform) -> tuple[Array, float]:
    """Solves inverse kinematics along a straight way on which the tool turns evenly.

    The arm that goes this way ends at these joint positions; that there are others for the same
    tool pose does not help it. A way that meets a joint's limit mostly keeps an error: steps are
    cut off there, and no other joint makes up for them. That is wanted, since an arm that came to
    its push with a joint at its limit often gets no further.

    Returns:
        As `solve_ik`.
    """
    X_WS = arm.tool_pose(q)
    offset = X_WE.translation() - X_WS.translation()
    turn = rotation_vector(X_WS.rotation(), X_WE.rotation())
    angle = float(np.linalg.norm(turn))
    axis = turn / angle if angle > 0.0 else np.array([0.0, 0.0, 1.0])
    steps = max(1, math.ceil(max(float(np.linalg.norm(offset)) / _WAY_STEP, angle / _WAY_TURN)))
    for share in np.arange(1, steps) / steps:
        turned = RotationMatrix(AngleAxis(share * angle, axis)).multiply(X_WS.rotation())
        X_WN = RigidTransform(turned, X_WS.translation() + share * offset)
        q, _ = solve_ik(arm, q, X_WN, _WAY_ITERATIONS)
    return solve_ik(arm, q, X_WE, _END_ITERATIONS)


def solve_ik(
    arm: ArmKinematics, q: Array, X_WE: RigidTransform, iterations: int = _ITERATIONS
) -> tuple[Array, float]:
    """Solves inverse kinematics from a start, by damped steps kept within the joint limits.

    Returns:
        Joint positions (7,) and what is left of the error, m (a tenth of it for rad).
    """
    lower, upper = arm.limits.lower + _MARGIN, arm.limits.upper - _MARGIN
    error = np.inf
    for _ in range(iterations):
        X_WNow = arm.tool_pose(q)
        offset = X_WE.translation() - X_WNow.translation()
        turn = rotation_vector(X_WNow.rotation(), X_WE.rotation())
        error = float(np.linalg.norm(offset) + _TURN_WEIGHT * np.linalg.norm(turn))
        if error < REACHED / 2:
            break
        dq = damped_least_squares(arm.jacobian(q), np.concatenate([offset, turn]), _DAMPING)
        q = np.clip(q + dq * min(1.0, _STEP / np.abs(dq).max()), lower, upper)
    return q, error
