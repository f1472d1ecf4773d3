"""ExpertPlanner and PushPlanner: what they aim at, their period, halt and reset."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw

from keypush.objects.library import make_object
from keypush.planning.plan_state import PlanState, Stage
from keypush.planning.push_frame import left_of, push_direction
from keypush.scenario import PlannerConfig, TableConfig
from keypush.systems.episode_seed import set_episode_seed
from keypush.systems.expert_planner import ExpertPlanner
from keypush.systems.push_planner import PushPlanner
from tests.control.arm import ARM, CONTROL
from tests.systems.closed_loop import PERIOD, ClosedLoop
from tests.systems.contract import everything, outputs, ports

BLOCK = make_object("block")
POINTS = BLOCK.surface_points(500, np.random.default_rng(0))
X_WO = RigidTransform(RollPitchYaw(0.0, 0.0, 0.4), np.array([0.03, 0.02, BLOCK.rest_height]))
P_WOCM = X_WO.rotation().matrix() @ BLOCK.p_OoOcm_O + X_WO.translation()
GOAL, KEYPOINT = np.array([0.1, -0.12]), np.array([0.0, 0.05, 0.02])
RESET = PlannerConfig(reset_period=3)
OUTPUTS = {"tool_action": 6, "stage": 1, "contact_target": 3}
TOOL = {"tool_pose": None, "arm_state": 14, "halted": 1}


def _expert(config: PlannerConfig | None = None) -> ClosedLoop:
    planner = ExpertPlanner(POINTS, ARM, config or PlannerConfig(), CONTROL, TableConfig(), PERIOD)
    return ClosedLoop(planner, {"object_pose": X_WO, "object_com": P_WOCM, "goal": GOAL})


def _pusher() -> ClosedLoop:
    planner = PushPlanner(ARM, PlannerConfig(), CONTROL, TableConfig(), PERIOD)
    return ClosedLoop(planner, {"keypoint": KEYPOINT, "goal": GOAL})


LOOPS = {"expert": _expert, "pusher": _pusher}


@pytest.fixture(params=LOOPS)
def loop(request: pytest.FixtureRequest) -> ClosedLoop:
    return LOOPS[request.param]()


def test_ports() -> None:
    assert ports(_expert().planner) == {
        "in": {"object_pose": None, "object_com": 3, "goal": 2, **TOOL},
        "out": OUTPUTS,
    }
    assert ports(_pusher().planner) == {
        "in": {"keypoint": 3, "goal": 2, "object_up": 3, **TOOL},
        "out": OUTPUTS,
    }


def test_outputs_are_pure_and_the_context_resets(loop: ClosedLoop) -> None:
    loop.simulator.AdvanceTo(0.35)
    before = everything(loop.context)
    first = outputs(loop.planner, loop.context)
    loop.simulator.get_mutable_context().DisableCaching()
    assert outputs(loop.planner, loop.context, -1) == first
    assert everything(loop.context) == before
    fresh = loop.planner.CreateDefaultContext()
    assert everything(fresh)[1:] != before[1:]
    loop.simulator.get_system().SetDefaultContext(loop.simulator.get_mutable_context())
    assert everything(loop.context)[1:] == everything(fresh)[1:]


def test_before_the_first_step_the_tool_stays(loop: ClosedLoop) -> None:
    np.testing.assert_array_equal(loop.output("tool_action"), np.zeros(6))
    assert loop.stage == Stage.RISE


def test_an_action_is_held_for_one_policy_step(loop: ClosedLoop) -> None:
    loop.simulator.AdvanceTo(0.01)
    held = outputs(loop.planner, loop.context)
    assert np.any(loop.output("tool_action") != 0)
    for time in (0.03, 0.06, 0.0999):
        loop.fix("goal", GOAL + time)
        loop.simulator.AdvanceTo(time)
        assert outputs(loop.planner, loop.context) == held
    loop.simulator.AdvanceTo(0.11)
    assert outputs(loop.planner, loop.context) != held


def test_the_same_episode_gives_the_same_bits(loop: ClosedLoop) -> None:
    loop.simulator.AdvanceTo(1.05)
    fresh = _expert() if isinstance(loop.planner, ExpertPlanner) else _pusher()
    fresh.simulator.AdvanceTo(1.05)
    assert outputs(fresh.planner, fresh.context) == outputs(loop.planner, loop.context)


def test_the_tool_comes_to_push_behind_its_target(loop: ClosedLoop) -> None:
    loop.run_until(Stage.PUSH)
    target = loop.output("contact_target")
    d_W = push_direction(target, GOAL)
    offset = loop.tool_pose.translation() - target
    assert -0.08 < offset @ d_W < 0.0
    assert abs(offset @ left_of(d_W)) < PlannerConfig().reapproach_error
    facing = loop.tool_pose.rotation().matrix()[:2, 2]
    assert facing @ d_W[:2] / np.linalg.norm(facing) > np.cos(0.15)
    ahead = offset @ d_W
    loop.simulator.AdvanceTo(loop.simulator.get_context().get_time() + 5 * PERIOD)
    assert (
        loop.tool_pose.translation() - target
    ) @ d_W > ahead + 2 * PERIOD * PlannerConfig().push_speed


def test_the_expert_aims_through_the_centre_of_mass() -> None:
    loop = _expert()
    loop.simulator.AdvanceTo(0.05)
    target, d_W = loop.output("contact_target"), push_direction(P_WOCM, GOAL)
    offset = target - P_WOCM
    assert abs(offset @ left_of(d_W)) < 1e-9
    # Behind, on the block's own outline.
    p_OK = X_WO.rotation().matrix().T @ (target - X_WO.translation())
    half = np.abs(BLOCK.vertices[:, :2]).max(axis=0)
    assert offset @ d_W < 0
    assert np.max(np.abs(p_OK[:2]) / half) == pytest.approx(1.0, abs=0.1)


def test_the_pusher_aims_at_the_keypoint() -> None:
    loop = _pusher()
    loop.simulator.AdvanceTo(0.05)
    np.testing.assert_array_equal(loop.output("contact_target"), KEYPOINT)


def test_halted_the_tool_comes_to_rest(loop: ClosedLoop) -> None:
    loop.run_until(Stage.APPROACH)
    loop.fix("halted", [1.0])
    assert loop.run_until(Stage.HALTED) == 1
    time = loop.simulator.get_context().get_time()
    loop.simulator.AdvanceTo(time + 2.0)
    rest = loop.tool_pose.translation()
    loop.simulator.AdvanceTo(time + 2.5)
    assert np.linalg.norm(loop.tool_pose.translation() - rest) < 1e-4
    assert loop.stage == Stage.HALTED


def _retreat(seed: int, episode: int) -> NDArray[np.float64]:
    """Where the expert's first reset goes, relative to the contact, along d and to its left."""
    loop = _expert(RESET)
    assert isinstance(loop.planner, ExpertPlanner)
    set_episode_seed(loop.context, seed, episode)
    loop.run_until(Stage.PUSH)
    assert loop.run_until(Stage.RETREAT) <= RESET.reset_period + 1
    held = loop.context.get_discrete_state(0).value()
    goes_to = PlanState.from_vector(held[: PlanState.SIZE]).p_WT
    d_W = push_direction(P_WOCM, GOAL)
    offset = goes_to - loop.output("contact_target")
    return np.array([offset @ d_W, offset @ left_of(d_W)])


def test_the_experts_reset_retreats_behind_the_contact_with_noise_of_the_episode() -> None:
    places = np.array([_retreat(seed, episode) for seed in (0, 1) for episode in (0, 1)])
    half = RESET.reset_deviation
    assert np.all(np.abs(places - [-RESET.reset_retreat, 0.0]) <= half)
    assert len({place.tobytes() for place in places}) == 4
    np.testing.assert_array_equal(_retreat(1, 0), places[2])


@pytest.mark.parametrize("reaim", [True, False])
def test_contact_and_direction_follow_the_object_unless_a_push_keeps_its_aim(reaim: bool) -> None:
    loop = _expert(PlannerConfig(reaim=reaim))
    loop.run_until(Stage.PUSH)
    before = loop.output("contact_target")
    loop.fix("object_com", P_WOCM + np.array([0.01, -0.02, 0.0]))
    loop.simulator.AdvanceTo(loop.simulator.get_context().get_time() + 2 * PERIOD)
    assert loop.stage == Stage.PUSH
    assert np.array_equal(loop.output("contact_target"), before) == (not reaim)


def test_without_a_reset_period_the_expert_never_lets_go() -> None:
    loop = _expert(PlannerConfig(reset_period=0))
    loop.run_until(Stage.PUSH)
    for _ in range(6):
        loop.simulator.AdvanceTo(loop.simulator.get_context().get_time() + PERIOD)
        assert loop.stage == Stage.PUSH


@pytest.mark.parametrize("seen", [True, False])
def test_the_pusher_gives_way_to_a_growing_tilt_where_it_sees_it(seen: bool) -> None:
    loop = _pusher()
    if seen:
        loop.fix("object_up", [0.0, 0.0, 1.0])
    loop.run_until(Stage.PUSH)
    d_W = push_direction(KEYPOINT, GOAL)
    forward = []
    for tilt in np.deg2rad([0.0, 0.8, 1.6, 2.4]):
        if seen:
            loop.fix("object_up", [np.sin(tilt), 0.0, np.cos(tilt)])
        loop.simulator.AdvanceTo(loop.simulator.get_context().get_time() + PERIOD)
        forward.append(loop.output("tool_action")[:3] @ d_W)
    assert min(forward[:2]) > 0.0
    assert (max(forward[2:]) < 0.0) == seen
