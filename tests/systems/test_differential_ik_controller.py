"""DifferentialIkController: clipped actions become joint targets within the limits."""

import numpy as np
from hypothesis import given
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context

from keypush.control.differential_ik import damped_least_squares
from keypush.planning.push_frame import rotation_vector
from keypush.systems.differential_ik_controller import DifferentialIkController
from tests.control.arm import ARM, CLIP, CONTROL, LIMITS, READY, Array, actions, positions
from tests.systems.contract import assert_pure, assert_resets, ports

PERIOD = 0.1
SMALL = np.array([0.01, -0.005, 0.004, 0.02, -0.01, 0.03])
CONTROLLER = DifferentialIkController(ARM, CONTROL, PERIOD)


def _start(q: Array, action: Array) -> tuple[Simulator, Context]:
    simulator = Simulator(CONTROLLER)
    context = simulator.get_mutable_context()
    _see(context, q)
    CONTROLLER.GetInputPort("tool_action").FixValue(context, action)
    simulator.Initialize()
    return simulator, context


def _see(context: Context, q: Array) -> None:
    state = np.concatenate([q, np.full(7, 0.1)])
    CONTROLLER.GetInputPort("arm_state").FixValue(context, state)


def _desired(context: Context) -> Array:
    return np.array(CONTROLLER.GetOutputPort("arm_desired_state").Eval(context))


def _target(q: Array, action: Array) -> Array:
    """The joint target of the first policy step."""
    simulator, context = _start(q, action)
    simulator.AdvanceTo(PERIOD / 2)
    desired = _desired(context)
    np.testing.assert_array_equal(desired[7:], np.zeros(7))
    return desired[:7]


def test_ports() -> None:
    assert ports(CONTROLLER) == {
        "in": {"tool_action": 6, "arm_state": 14},
        "out": {"arm_desired_state": 14},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    simulator, context = _start(READY, SMALL)
    simulator.AdvanceTo(0.25)
    assert_pure(CONTROLLER, context)
    assert_resets(CONTROLLER, context)


def test_before_the_first_update_the_arm_holds_its_position() -> None:
    context = CONTROLLER.CreateDefaultContext()
    _see(context, READY)
    CONTROLLER.GetInputPort("tool_action").FixValue(context, SMALL)
    CONTROLLER.ExecuteInitializationEvents(context)
    np.testing.assert_array_equal(_desired(context), [*READY, *np.zeros(7)])


def test_a_target_is_held_for_one_policy_step() -> None:
    simulator, context = _start(READY, SMALL)
    simulator.AdvanceTo(0.01)
    held = _desired(context)
    for time in (0.03, 0.06, 0.09, 0.0999):
        _see(context, READY + time)
        CONTROLLER.GetInputPort("tool_action").FixValue(context, time * SMALL)
        simulator.AdvanceTo(time)
        np.testing.assert_array_equal(_desired(context), held)
    simulator.AdvanceTo(0.11)
    assert np.all(_desired(context)[:7] != held[:7])
    np.testing.assert_array_equal(held[:7], _target(READY, SMALL))


@given(positions(), actions)
def test_targets_keep_the_position_and_velocity_limits(q: Array, action: Array) -> None:
    target = _target(q, 10 * action)
    assert np.all(target >= LIMITS.lower - 1e-9)
    assert np.all(target <= LIMITS.upper + 1e-9)
    assert np.all(np.abs(target - q) <= LIMITS.velocity * PERIOD + 1e-9)


@given(positions(beyond=0.3), actions)
def test_from_beyond_a_limit_a_joint_comes_back(q: Array, action: Array) -> None:
    target = _target(q, action)
    reach = LIMITS.velocity * PERIOD
    assert np.all(target >= np.minimum(LIMITS.lower, q + reach) - 1e-9)
    assert np.all(target <= np.maximum(LIMITS.upper, q - reach) + 1e-9)


def test_far_from_limits_it_is_damped_least_squares() -> None:
    expected = READY + damped_least_squares(ARM.jacobian(READY), SMALL, CONTROL.damping)
    np.testing.assert_allclose(_target(READY, SMALL), expected, atol=1e-12)


@given(actions)
def test_an_action_is_clipped_on_every_axis(action: Array) -> None:
    beyond = 20 * action
    clipped = np.clip(beyond, -CLIP, CLIP)
    np.testing.assert_array_equal(_target(READY, beyond), _target(READY, clipped))


def test_an_action_at_its_clip_is_not_shortened() -> None:
    for axis in range(6):
        action = CLIP * np.eye(6)[axis]
        np.testing.assert_array_equal(_target(READY, 1.5 * action), _target(READY, action))
        assert np.any(_target(READY, 0.9 * action) != _target(READY, action))


def test_in_a_closed_loop_the_tool_reaches_a_small_step() -> None:
    start = ARM.tool_pose(READY)
    goal = start.translation() + SMALL[:3]
    simulator, context = _start(READY, np.zeros(6))
    errors = []
    for k in range(30):
        q = _desired(context)[:7]
        X_WE = ARM.tool_pose(q)
        offset = goal - X_WE.translation()
        turn = rotation_vector(X_WE.rotation(), start.rotation())
        errors.append(float(np.linalg.norm([*offset, *turn])))
        _see(context, q)
        CONTROLLER.GetInputPort("tool_action").FixValue(context, np.array([*offset, *turn]))
        simulator.AdvanceTo((k + 0.5) * PERIOD)
    assert errors[0] > 0.01
    assert errors[-1] < 1e-4
    assert np.all(np.diff(errors) <= 1e-9)
