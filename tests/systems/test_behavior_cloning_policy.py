"""BehaviorCloningPolicy: the network's action at 10 Hz, clipped, until the stop."""

from typing import override

import numpy as np
import pytest
from numpy.typing import NDArray

from keypush.learning.model import PolicyError
from keypush.planning.plan_state import Stage
from keypush.scenario import ControlConfig
from keypush.systems.behavior_cloning_policy import BehaviorCloningPolicy
from tests.systems.contract import outputs, ports
from tests.systems.scene import (
    PERIOD,
    POINTS,
    SceneBench,
    SpyModel,
    Vector,
    check_purity_and_reset,
    check_what_the_model_sees,
)

CLOUD = 2.0 * np.random.default_rng(0).normal(size=(POINTS, 3))
CONTROL = ControlConfig()
CLIPS = np.repeat([CONTROL.max_translation, CONTROL.max_rotation], 3)


class FirstNumbers(SpyModel):
    """The cloud's first six numbers."""

    @override
    def answer(self, cloud_W: Vector) -> NDArray[np.float64]:
        return np.array(cloud_W[:2].ravel(), dtype=float)


class Scene(SceneBench):
    """A policy alone, its inputs fixed."""

    def __init__(self) -> None:
        model = FirstNumbers()
        super().__init__(model, BehaviorCloningPolicy(model, POINTS, CONTROL, PERIOD), CLOUD)
        self.fix("halted", [0.0])

    def halt(self) -> None:
        self.fix("halted", [1.0])


def _action(cloud: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.clip(cloud[:2].ravel(), -CLIPS, CLIPS))


def test_ports() -> None:
    inputs = {"point_cloud": 3 * POINTS, "goal": 2, "tool_pose": None, "object_com": 3, "halted": 1}
    assert ports(Scene().system) == {
        "in": inputs,
        "out": {"tool_action": 6, "stage": 1, "contact_target": 3},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    check_purity_and_reset(Scene())


def test_the_model_sees_cloud_goal_com_and_hand() -> None:
    check_what_the_model_sees(Scene(), CLOUD)


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
def test_an_action_that_is_not_finite_ends_the_simulation(bad: float) -> None:
    scene = Scene()
    scene.simulator.AdvanceTo(0.15)
    scene.see(np.where(np.arange(POINTS)[:, np.newaxis] == 1, bad, CLOUD))
    with pytest.raises(PolicyError, match=r"^action is not finite$"):
        scene.simulator.AdvanceTo(0.35)
    np.testing.assert_array_equal(scene.output("tool_action"), _action(CLOUD))


def test_without_a_first_action_there_is_no_simulation() -> None:
    scene = Scene()
    scene.see(np.full((POINTS, 3), np.nan))
    with pytest.raises(PolicyError, match=r"^action is not finite$"):
        scene.simulator.Initialize()


def test_the_same_episode_gives_the_same_bits() -> None:
    scenes = Scene(), Scene()
    for scene in scenes:
        scene.simulator.AdvanceTo(0.55)
    first, again = (outputs(scene.system, scene.context) for scene in scenes)
    assert first == again
    scenes[0].context.SetTime(0.0)
    scenes[0].simulator.Initialize()
    np.testing.assert_array_equal(scenes[0].output("tool_action"), np.zeros(6))
