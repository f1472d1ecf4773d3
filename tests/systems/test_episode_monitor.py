"""EpisodeMonitor: every outcome, from poses that follow a script."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.systems.analysis import Simulator, SimulatorStatus
from pydrake.systems.framework import BasicVector, Context, DiagramBuilder, LeafSystem
from pydrake.systems.primitives import ConstantVectorSource

from keypush.scenario import EpisodeConfig, TableConfig
from keypush.systems.episode_monitor import EpisodeMonitor, Outcome
from tests.systems.contract import assert_pure, assert_resets, ports

CONFIG = EpisodeConfig(max_steps=20)
PERIOD = CONFIG.policy_period
TABLE = TableConfig()
EDGE = np.array([TABLE.length, TABLE.width]) / 2
HALF = np.array([0.03, 0.02, 0.04])
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF
P_OCM = np.array([0.01, 0.0, -0.01])
GOAL = np.array([0.1, -0.05])
START = RigidTransform(np.array([-0.1, 0.0, HALF[2]]))
THERE = RigidTransform(np.array([*GOAL, HALF[2]]))
Pose = Callable[[float], RigidTransform]


def _away(tool_speed: float, until: float) -> Pose:
    """A tool that moves until some time."""
    return lambda t: RigidTransform(np.array([0.0, 0.0, 0.1 + tool_speed * min(t, until)]))


class Script(LeafSystem):
    """Poses as functions of time."""

    def __init__(self, pose: Pose, com: Pose, tool: Pose) -> None:
        super().__init__()

        def calc_com(context: Context, output: BasicVector) -> None:
            output.SetFromVector(com(context.get_time()) @ P_OCM)

        self.DeclareVectorOutputPort("object_com", 3, calc_com)
        self._declare("object_pose", pose)
        self._declare("tool_pose", tool)

    def _declare(self, name: str, pose: Pose) -> None:
        def calc(context: Any, output: Any) -> None:
            output.set_value(pose(context.get_time()))

        self.DeclareAbstractOutputPort(name, lambda: Value(RigidTransform()), calc)


@dataclass
class Scene:
    """A monitor that watches an object which follows a script."""

    pose: Pose
    config: EpisodeConfig = field(default_factory=lambda: CONFIG)
    com: Pose | None = None
    tool: Pose = field(default_factory=lambda: _away(0.0, 0.0))

    def __post_init__(self) -> None:
        builder = DiagramBuilder()
        script = builder.AddSystem(Script(self.pose, self.com or self.pose, self.tool))
        goal = builder.AddSystem(ConstantVectorSource(GOAL))
        self.monitor = builder.AddSystem(EpisodeMonitor(CORNERS, self.config, TABLE))
        for name in ("object_pose", "object_com", "tool_pose"):
            builder.Connect(script.GetOutputPort(name), self.monitor.GetInputPort(name))
        builder.Connect(goal.get_output_port(), self.monitor.GetInputPort("goal"))
        self.simulator = Simulator(builder.Build())
        self.context = self.monitor.GetMyMutableContextFromRoot(
            self.simulator.get_mutable_context()
        )

    def run(self, until: float = 30.0) -> SimulatorStatus:
        return self.simulator.AdvanceTo(until)

    @property
    def time(self) -> float:
        """When the simulation ended."""
        return float(self.simulator.get_context().get_time())

    def output(self, name: str) -> NDArray[np.float64]:
        return np.array(self.monitor.GetOutputPort(name).Eval(self.context))

    def verdict(self) -> tuple[Outcome, int, bool]:
        outcome, steps, settled = self.output("verdict")
        return Outcome(int(outcome)), int(steps), bool(settled)


def _from(time: float, later: RigidTransform, first: RigidTransform = START) -> Pose:
    """One pose, and another one from some time on."""
    return lambda t: later if t > time - 1e-9 else first


def _still(_: float) -> RigidTransform:
    return START


def _turned(roll: float, pitch: float = 0.0, yaw: float = 0.0) -> RigidTransform:
    return RigidTransform(RollPitchYaw(roll, pitch, yaw), START.translation())


def _shifted(dx: float, dy: float, dz: float = 0.0, to: RigidTransform = THERE) -> RigidTransform:
    return RigidTransform(to.rotation(), to.translation() + np.array([dx, dy, dz]))


def test_ports() -> None:
    assert ports(EpisodeMonitor(CORNERS, CONFIG, TABLE)) == {
        "in": {"object_pose": None, "object_com": 3, "goal": 2, "tool_pose": None},
        "out": {"halted": 1, "verdict": 3},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    scene = Scene(_from(0.3, THERE))
    scene.run(0.55)
    alone = scene.monitor.CreateDefaultContext()
    for name, value in (("object_pose", THERE), ("tool_pose", START)):
        scene.monitor.GetInputPort(name).FixValue(alone, value)
    scene.monitor.GetInputPort("object_com").FixValue(alone, THERE @ P_OCM)
    scene.monitor.GetInputPort("goal").FixValue(alone, GOAL)
    alone.SetTimeStateAndParametersFrom(scene.context)
    assert_pure(scene.monitor, alone)
    assert_resets(scene.monitor, alone)


def test_while_nothing_happens_the_episode_goes_on_until_its_time_is_up() -> None:
    scene = Scene(_still)
    scene.run((CONFIG.max_steps - 0.5) * PERIOD)
    assert scene.time == (CONFIG.max_steps - 0.5) * PERIOD
    assert scene.verdict()[0] == Outcome.RUNNING
    assert scene.output("halted") == 0
    status = scene.run()
    assert scene.verdict() == (Outcome.TIMED_OUT, CONFIG.max_steps, False)
    assert status.reason() == SimulatorStatus.ReturnReason.kReachedTerminationCondition
    assert "TIMED_OUT" in status.FormatMessage()
    np.testing.assert_allclose(scene.time, CONFIG.max_steps * PERIOD)


def test_success_halts_the_tool_and_ends_after_the_settled_test() -> None:
    scene = Scene(_from(0.5, THERE))
    scene.run(0.49)
    assert scene.output("halted") == 0
    scene.run(0.55)
    assert scene.output("halted") == 1
    assert scene.verdict() == (Outcome.SUCCESS, 5, False)
    status = scene.run()
    assert "SUCCESS" in status.FormatMessage()
    assert scene.verdict() == (Outcome.SUCCESS, 5, True)
    np.testing.assert_allclose(scene.time, 0.5 + CONFIG.settle_time, atol=PERIOD + 1e-9)


def test_success_in_the_last_step_counts() -> None:
    scene = Scene(_from(CONFIG.max_steps * PERIOD, THERE))
    scene.run()
    assert scene.verdict() == (Outcome.SUCCESS, CONFIG.max_steps, True)


@pytest.mark.parametrize(
    "later",
    [
        _shifted(0.06, 0.0),
        RigidTransform(RollPitchYaw(0.5, 0.0, 0.0), THERE.translation()),
        _shifted(0.0, 0.0, -0.3),
    ],
    ids=["rolled away", "toppled", "fell"],
)
def test_what_does_not_last_is_success_but_not_settled(later: RigidTransform) -> None:
    scene = Scene(lambda t: START if t < 0.49 else THERE if t < 0.95 else later)
    scene.run()
    assert scene.verdict() == (Outcome.SUCCESS, 5, False)


@pytest.mark.parametrize("gone", [_shifted(0.0, 0.0, -0.3), _shifted(0.12, 0.0)])
def test_settled_means_on_the_table(gone: RigidTransform) -> None:
    """Even where any change of height passes for upright and any place for the goal."""
    config = EpisodeConfig(max_steps=20, max_height_change=1.0, goal_radius=0.15)
    scene = Scene(lambda t: START if t < 0.49 else THERE if t < 0.95 else gone, config=config)
    scene.run()
    assert scene.verdict() == (Outcome.SUCCESS, 5, False)


def test_the_settled_test_waits_for_the_tool_to_stop() -> None:
    scene = Scene(_from(0.5, THERE), tool=_away(0.05, 1.2))
    scene.run()
    assert scene.verdict() == (Outcome.SUCCESS, 5, True)
    np.testing.assert_allclose(scene.time, 1.2 + CONFIG.settle_time, atol=PERIOD + 1e-9)


def test_a_tool_that_never_stops_is_not_waited_for_forever() -> None:
    scene = Scene(_from(0.5, THERE), tool=_away(0.05, np.inf))
    status = scene.run()
    assert status.reason() == SimulatorStatus.ReturnReason.kReachedTerminationCondition
    assert scene.time < 5.0


radius = CONFIG.goal_radius
angles = st.floats(-np.pi, np.pi)


@settings(max_examples=25)
@given(angles, st.floats(0.0, 0.0499))
def test_within_the_radius_of_the_goal_is_success(angle: float, distance: float) -> None:
    near = _shifted(distance * np.cos(angle), distance * np.sin(angle))
    scene = Scene(_from(0.3, near))
    scene.run(0.35)
    assert scene.verdict()[0] == Outcome.SUCCESS


@settings(max_examples=25)
@given(angles, st.floats(0.0501, 0.089))
def test_outside_of_it_is_not(angle: float, distance: float) -> None:
    far = _shifted(distance * np.cos(angle), distance * np.sin(angle))
    scene = Scene(_from(0.3, far))
    scene.run(0.35)
    assert scene.verdict()[0] == Outcome.RUNNING


@settings(max_examples=25)
@given(angles, angles, angles)
def test_a_turn_about_the_vertical_is_no_tilt(start: float, end: float, axis: float) -> None:
    """Whatever side of the object is up at the start."""
    lying = _turned(np.pi / 2, 0.0, start) if axis > 0 else _turned(0.0, 0.0, start)
    turned = RigidTransform(
        RotationMatrix.MakeZRotation(end) @ lying.rotation(), lying.translation()
    )
    scene = Scene(_from(0.3, _shifted(0.02, 0.0, to=turned), first=lying))
    scene.run(0.45)
    assert scene.verdict()[0] == Outcome.RUNNING


@settings(max_examples=25)
@given(angles, st.booleans())
def test_the_tilt_decides_whether_it_is_upright(axis: float, over: bool) -> None:
    # The reference points are near the axis here, so that only the angle decides.
    config = EpisodeConfig(max_steps=20, max_height_change=1.0)
    tilt = np.deg2rad(config.max_tilt_deg + (0.1 if over else -0.1))
    turned = _turned(tilt * np.cos(axis), tilt * np.sin(axis))
    angle = np.arccos(turned.rotation().matrix()[2, 2])
    scene = Scene(_from(0.3, turned), config=config)
    scene.run(0.35)
    expected = Outcome.TOPPLED if angle > np.deg2rad(config.max_tilt_deg) else Outcome.RUNNING
    assert scene.verdict()[0] == expected


@pytest.mark.parametrize("sign", [1, -1])
def test_the_height_of_the_com_decides_too(sign: int) -> None:
    limit = sign * CONFIG.max_height_change
    for change, expected in ((0.95 * limit, Outcome.RUNNING), (1.05 * limit, Outcome.TOPPLED)):
        raised = RigidTransform(START.translation() + np.array([0.0, 0.0, change]))
        scene = Scene(_from(0.3, START), com=_from(0.3, raised))
        scene.run(0.35)
        assert scene.verdict()[0] == expected


def test_the_reference_points_decide_too() -> None:
    """A tilt that moves a far corner up by more than 2 cm, though its angle is small."""
    config = EpisodeConfig(max_steps=20, max_height_change=0.003)
    scene = Scene(_from(0.3, _turned(0.0, 0.09)), config=config, com=_still)
    scene.run(0.35)
    assert scene.verdict()[0] == Outcome.RUNNING
    scene = Scene(_from(0.3, _turned(0.0, 0.13)), config=config, com=_still)
    scene.run(0.35)
    assert scene.verdict()[0] == Outcome.TOPPLED


@pytest.mark.parametrize(
    ("later", "outcome"),
    [(_turned(1.0), Outcome.TOPPLED), (_shifted(0.0, 0.0, -0.2, START), Outcome.FELL)],
)
def test_a_failure_ends_the_episode_at_once(later: RigidTransform, outcome: Outcome) -> None:
    scene = Scene(_from(0.7, later))
    status = scene.run()
    assert scene.verdict() == (outcome, 7, False)
    np.testing.assert_allclose(scene.time, 0.7)
    assert outcome.name in status.FormatMessage()
    assert scene.output("halted") == 0


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("tilt", [0.0, 1.2])
def test_what_tips_over_the_edge_falls(axis: int, sign: int, tilt: float) -> None:
    """Seen while its COM is still above the table top, and already tilted or not yet."""
    for beyond, expected in (
        (0.001, Outcome.FELL),
        (-0.001, Outcome.TOPPLED if tilt else Outcome.RUNNING),
    ):
        p_WOcm = (R := RollPitchYaw(tilt, 0.0, 0.0).ToRotationMatrix()) @ P_OCM + [0, 0, HALF[2]]
        shift = np.zeros(3)
        shift[axis] = sign * (EDGE[axis] + beyond) - p_WOcm[axis]
        scene = Scene(_from(0.3, RigidTransform(R, START.translation() * [0, 0, 1] + shift)))
        scene.run(0.35)
        assert scene.verdict()[0] == expected


def test_a_toppled_object_at_the_goal_is_no_success() -> None:
    there = RigidTransform(RollPitchYaw(1.5, 0.0, 0.0), THERE.translation())
    scene = Scene(_from(0.3, there))
    scene.run()
    assert scene.verdict()[0] == Outcome.TOPPLED


def test_a_second_episode_is_judged_like_the_first() -> None:
    scene = Scene(_from(0.5, THERE))
    scene.run()
    first = scene.verdict()
    root = scene.simulator.get_mutable_context()
    scene.simulator.get_system().SetDefaultContext(root)
    root.SetTime(0.0)
    scene.simulator.Initialize()
    assert scene.verdict()[0] == Outcome.RUNNING
    scene.run()
    assert scene.verdict() == first
