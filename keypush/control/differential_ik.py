"""One step of differential inverse kinematics: damped least squares within joint limits."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.solvers import MathematicalProgram, OsqpSolver, SolverOptions
from scipy.linalg.lapack import dposv

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointLimits:
    """Position limits (n,) in rad and velocity limits (n,) in rad/s."""

    lower: Array
    upper: Array
    velocity: Array

    def step_bounds(self, q: Array, period: float) -> tuple[Array, Array]:
        """Returns the bounds (n,), (n,) of a joint step that keeps the limits.

        A joint beyond its position limit must come back, as fast as its velocity allows.
        """
        reach = self.velocity * period
        return np.clip(self.lower - q, -reach, reach), np.clip(self.upper - q, -reach, reach)


def damped_least_squares(J: Array, a: Array, damping: float) -> Array:
    """Returns dq = J^T (J J^T + damping I)^-1 a, shape (n,).

    Args:
        J: (6, n) Jacobian.
        a: (6,) residual of the tool pose, in the order of J's rows.
        damping: lambda^2.
    """
    gram = J @ J.T
    gram.flat[:: len(gram) + 1] += damping
    _, x, _ = dposv(gram, a)  # positive definite as damping > 0; far quicker than np.linalg
    return np.asarray(J.T @ x)


def undamped_action(J: Array, a: Array, damping: float, largest_gain: float) -> Array:
    """Returns the action (6,) whose damped least squares step moves the tool by a.

    The damping shortens every singular direction of J by sigma^2 / (sigma^2 + damping), and
    so bends straight lines; this undoes it, up to `largest_gain` near singularities.

    Args:
        J: (6, n) Jacobian.
        a: (6,) wanted displacement of the tool, in the order of J's rows.
        damping: lambda^2 of the damped least squares.
        largest_gain: bound on the correction of every singular direction.
    """
    values, axes = np.linalg.eigh(J @ J.T)
    gain = np.minimum(1 + damping / np.maximum(values, 1e-12), largest_gain)
    return np.asarray(axes @ (gain * (axes.T @ a)))


def solve_box_qp(J: Array, a: Array, damping: float, lower: Array, upper: Array) -> Array:
    """Minimises |J dq - a|^2 + damping |dq|^2 subject to lower <= dq <= upper, with OSQP.

    OSQP runs through Drake, which sets it up afresh for every solve: its result depends on
    the arguments alone. The osqp package would keep a warm start between solves, and an
    episode's rows would then depend on what the process had solved before.

    Raises:
        RuntimeError: OSQP found no solution; a box with lower <= upper always has one.
    """
    program = MathematicalProgram()
    dq = program.NewContinuousVariables(J.shape[1], "dq")
    hessian = 2 * (J.T @ J + damping * np.eye(J.shape[1]))
    program.AddQuadraticCost(hessian, -2 * J.T @ a, dq, is_convex=True)
    program.AddBoundingBoxConstraint(lower, upper, dq)
    options = SolverOptions()
    for name in ("eps_abs", "eps_rel"):
        options.SetOption(OsqpSolver.id(), name, 1e-9)
    options.SetOption(OsqpSolver.id(), "max_iter", 20_000)
    options.SetOption(OsqpSolver.id(), "polishing", 0)
    result = OsqpSolver().Solve(program, None, options)
    if not result.is_success():
        raise RuntimeError(f"differential IK: OSQP ended with {result.get_solution_result()}")
    return np.clip(result.GetSolution(dq), lower, upper)


def solve_differential_ik(J: Array, a: Array, damping: float, lower: Array, upper: Array) -> Array:
    """Returns the joint step (n,) of the box-constrained damped least squares.

    Where the unconstrained minimiser keeps the box it is the QP's solution (the QP is
    convex and no constraint is active), so OSQP runs only where a limit binds.
    """
    dq = damped_least_squares(J, a, damping)
    if np.all(dq >= lower) and np.all(dq <= upper):
        return dq
    return solve_box_qp(J, a, damping, lower, upper)
