"""Differential IK against independent solvers and the conditions of optimality."""

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from keypush.control.differential_ik import (
    damped_least_squares,
    solve_box_qp,
    solve_differential_ik,
    undamped_action,
)
from tests.control.arm import ARM, CONTROL, LIMITS, Array, actions, positions, vectors

PERIOD = 0.1
LAMBDA2 = CONTROL.damping
boxes = st.tuples(vectors(7, -0.1, 0.02), vectors(7, 0.0, 0.1)).map(
    lambda pair: (pair[0], np.maximum(*pair))
)
"""Boxes (lower, upper), many of them too narrow or beside zero."""


@given(positions(), actions)
def test_damped_least_squares_is_the_minimum(q: Array, a: Array) -> None:
    J = ARM.jacobian(q)
    dq = damped_least_squares(J, a, LAMBDA2)
    stacked = np.vstack([J, np.sqrt(LAMBDA2) * np.eye(7)])
    expected = np.linalg.lstsq(stacked, np.concatenate([a, np.zeros(7)]), rcond=None)[0]
    np.testing.assert_allclose(dq, expected, atol=1e-12)


@given(positions(), actions)
def test_the_qp_is_damped_least_squares_when_no_limit_binds(q: Array, a: Array) -> None:
    J = ARM.jacobian(q)
    wide = np.full(7, 100.0)
    expected = damped_least_squares(J, a, LAMBDA2)
    np.testing.assert_allclose(solve_box_qp(J, a, LAMBDA2, -wide, wide), expected, atol=1e-6)
    np.testing.assert_array_equal(solve_differential_ik(J, a, LAMBDA2, -wide, wide), expected)


@given(positions(), actions, boxes)
def test_within_a_box_it_is_the_optimum(q: Array, a: Array, box: tuple[Array, Array]) -> None:
    J, (lower, upper) = ARM.jacobian(q), box
    dq = solve_differential_ik(J, a, LAMBDA2, lower, upper)
    assert np.all((dq >= lower) & (dq <= upper))
    # The conditions of Karush, Kuhn and Tucker: the gradient may only point out of the box.
    gradient = J.T @ (J @ dq - a) + LAMBDA2 * dq
    tight = 1e-6
    assert np.all(gradient[dq > lower + tight] < tight)
    assert np.all(gradient[dq < upper - tight] > -tight)


@given(positions(), actions, boxes)
def test_the_qp_agrees_with_another_solver(q: Array, a: Array, box: tuple[Array, Array]) -> None:
    J, (lower, upper) = ARM.jacobian(q), box
    assume(np.all(upper - lower > 1e-9))  # the other solver refuses a box without an inside
    stacked = np.vstack([J, np.sqrt(LAMBDA2) * np.eye(7)])
    right = np.concatenate([a, np.zeros(7)])
    expected = lsq_linear(stacked, right, (lower, upper), method="bvls", tol=1e-14).x
    np.testing.assert_allclose(solve_box_qp(J, a, LAMBDA2, lower, upper), expected, atol=1e-5)


@given(positions(), actions, boxes)
def test_same_arguments_same_bits(q: Array, a: Array, box: tuple[Array, Array]) -> None:
    J = ARM.jacobian(q)
    first = solve_box_qp(J, a, LAMBDA2, *box)
    solve_box_qp(J, -a, LAMBDA2, *box)
    assert solve_box_qp(J, a, LAMBDA2, *box).tobytes() == first.tobytes()


@given(positions(beyond=0.5))
def test_step_bounds_keep_position_and_velocity_limits(q: Array) -> None:
    lower, upper = LIMITS.step_bounds(q, PERIOD)
    reach = LIMITS.velocity * PERIOD
    assert np.all(lower <= upper)
    assert np.all((-reach <= lower) & (upper <= reach))
    for end in (q + lower, q + upper):
        inside = (end >= LIMITS.lower - 1e-12) & (end <= LIMITS.upper + 1e-12)
        # From outside the limits a joint comes back as fast as it may.
        back = np.where(q < LIMITS.lower, end - q, q - end)
        np.testing.assert_allclose(back[~inside], reach[~inside])


@given(positions(), actions)
def test_undamped_action_moves_the_tool_by_what_is_wanted(q: Array, a: Array) -> None:
    J = ARM.jacobian(q)
    gain = 3.0
    action = undamped_action(J, a, LAMBDA2, gain)
    moved = J @ damped_least_squares(J, action, LAMBDA2)
    values, axes = np.linalg.eigh(J @ J.T)
    # Directions in which the correction stays below its bound, away from singularities.
    good = axes[:, values > LAMBDA2 / (gain - 1)]
    np.testing.assert_allclose(good.T @ moved, good.T @ a, atol=1e-9)
    assert np.linalg.norm(action) <= gain * np.linalg.norm(a) + 1e-12
    assert np.linalg.norm(moved) <= np.linalg.norm(a) + 1e-12


def test_undamped_action_is_bounded_at_a_singularity() -> None:
    J = np.zeros((6, 7))
    J[0, 0] = 1.0
    action = undamped_action(J, np.ones(6), LAMBDA2, 3.0)
    np.testing.assert_allclose(action, [1 + LAMBDA2, 3, 3, 3, 3, 3])
