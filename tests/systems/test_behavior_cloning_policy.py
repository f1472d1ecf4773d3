"""BehaviorCloningPolicy: the network's action at 10 Hz, clipped, until the stop."""

import logging
from typing import override

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context

from keypush.learning.model import ActionModel
from keypush.planning.plan_state import Stage
from keypush.scenario import ControlConfig
from keypush.systems.behavior_cloning_policy import BehaviorCloningPolicy
from tests.systems.contract import assert_pure, assert_resets, outputs, ports

PERIOD, POINTS = 0.1, 16
CLOUD = 2.0 * np.random.default_rng(0).normal(size=(POINTS, 3))
GOAL, COM = np.array([0.1, -0.05]), np.array([0.01, 0.02, 0.03])
X_WE = RigidTransform(RollPitchYaw(3.0, 0.2, -1.0), np.array([0.1, 0.2, 0.3]))
CONTROL = ControlConfig()
CLIPS = np.repeat([CONTROL.max_translation, CONTROL.max_rotation], 3)
Vector = NDArray[np.floating]


class SpyModel(ActionModel):
    """The cloud's first six numbers; remembers what it was asked."""

    def __init__(self) -> None:
        self.calls: list[tuple[Vector, Vector, Vector | None, Vector]] = []

    @property
    @override
    def uses_com(self) -> bool:
        return True

    @override
    def predict(
        self, cloud_W: Vector, goal_W: Vector, com_W: Vector | None, hand: Vector
    ) -> NDArray[np.float64]:
        com = None if com_W is None else com_W.copy()
        self.calls.append((cloud_W.copy(), goal_W.copy(), com, hand.copy()))
        return np.array(cloud_W[:2].ravel(), dtype=float)


class Scene:
    """A policy alone, its inputs fixed."""

    def __init__(self) -> None:
        self.model = SpyModel()
        self.policy = BehaviorCloningPolicy(self.model, POINTS, CONTROL, PERIOD)
        self.simulator = Simulator(self.policy)
        self.context: Context = self.simulator.get_mutable_context()
        self.see(CLOUD)
        fixed = {"goal": GOAL, "tool_pose": X_WE, "object_com": COM, "halted": [0.0]}
        for name, value in fixed.items():
            self.policy.GetInputPort(name).FixValue(self.context, value)

    def see(self, cloud: NDArray[np.float64]) -> None:
        self.policy.GetInputPort("point_cloud").FixValue(self.context, cloud.ravel())

    def halt(self) -> None:
        self.policy.GetInputPort("halted").FixValue(self.context, [1.0])

    def output(self, name: str) -> NDArray[np.float64]:
        return np.array(self.policy.GetOutputPort(name).Eval(self.context))


def _action(cloud: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.clip(cloud[:2].ravel(), -1, 1) * CLIPS)


def test_ports() -> None:
    inputs = {"point_cloud": 3 * POINTS, "goal": 2, "tool_pose": None, "object_com": 3, "halted": 1}
    assert ports(Scene().policy) == {
        "in": inputs,
        "out": {"tool_action": 6, "stage": 1, "contact_target": 3, "rejected": 1},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    scene = Scene()
    scene.simulator.AdvanceTo(0.25)
    asked = len(scene.model.calls)
    assert_pure(scene.policy, scene.context)
    assert len(scene.model.calls) == asked
    assert_resets(scene.policy, scene.context)


def test_the_model_sees_cloud_goal_com_and_hand() -> None:
    scene = Scene()
    scene.simulator.Initialize()
    cloud, goal, com, hand = scene.model.calls[0]
    R_WE = X_WE.rotation().matrix()
    np.testing.assert_array_equal(cloud, CLOUD)
    np.testing.assert_array_equal(goal, GOAL)
    np.testing.assert_array_equal(com, COM)
    np.testing.assert_array_equal(hand, [*X_WE.translation(), *R_WE[:, 0], *R_WE[:, 1]])


def test_before_the_first_step_the_tool_stays() -> None:
    scene = Scene()
    scene.simulator.Initialize()
    np.testing.assert_array_equal(scene.output("tool_action"), np.zeros(6))
    assert scene.output("stage") == Stage.PUSH
    assert np.isnan(scene.output("contact_target")).all()


def test_an_action_is_decided_on_its_own_steps_cloud_clipped_and_held() -> None:
    assert np.abs(CLOUD[:2]).max() > 1
    scene = Scene()
    scene.simulator.AdvanceTo(0.01)
    np.testing.assert_array_equal(scene.output("tool_action"), _action(CLOUD))
    for time in (0.03, 0.06, 0.0999):
        scene.see(CLOUD + time)
        scene.simulator.AdvanceTo(time)
        np.testing.assert_array_equal(scene.output("tool_action"), _action(CLOUD))
    scene.simulator.AdvanceTo(0.11)
    np.testing.assert_array_equal(scene.output("tool_action"), _action(CLOUD + 0.0999))


def test_halted_the_tool_stays_from_then_on() -> None:
    scene = Scene()
    scene.simulator.AdvanceTo(0.15)
    scene.halt()
    scene.simulator.AdvanceTo(0.25)
    asked = len(scene.model.calls)
    scene.simulator.AdvanceTo(0.45)
    np.testing.assert_array_equal(scene.output("tool_action"), np.zeros(6))
    assert scene.output("stage") == Stage.HALTED
    assert len(scene.model.calls) == asked


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_held_back_counted_and_logged(
    bad: float, caplog: pytest.LogCaptureFixture
) -> None:
    scene = Scene()
    scene.simulator.AdvanceTo(0.15)
    scene.see(np.where(np.arange(POINTS)[:, np.newaxis] == 1, bad, CLOUD))
    with caplog.at_level(logging.WARNING):
        scene.simulator.AdvanceTo(0.35)
    np.testing.assert_array_equal(scene.output("tool_action"), _action(CLOUD))
    assert scene.output("rejected") == 2
    assert [r.getMessage() for r in caplog.records] == [
        f"prediction at {t} s is not finite: held" for t in (0.2, 0.3)
    ]


def test_without_a_first_action_the_simulation_fails() -> None:
    scene = Scene()
    scene.see(np.full((POINTS, 3), np.nan))
    with pytest.raises(RuntimeError, match="first prediction is not finite"):
        scene.simulator.Initialize()


def test_the_same_episode_gives_the_same_bits() -> None:
    scenes = Scene(), Scene()
    for scene in scenes:
        scene.simulator.AdvanceTo(0.55)
    first, again = (outputs(scene.policy, scene.context) for scene in scenes)
    assert first == again
    scenes[0].context.SetTime(0.0)
    scenes[0].simulator.Initialize()
    np.testing.assert_array_equal(scenes[0].output("tool_action"), np.zeros(6))
