"""KeypointPredictor: predictions at 10 Hz; one that is not finite ends the simulation."""

from typing import override

import numpy as np
import pytest
from numpy.typing import NDArray

from keypush.learning.model import PolicyError
from keypush.systems.keypoint_predictor import KeypointPredictor
from tests.systems.contract import ports
from tests.systems.scene import (
    COM,
    PERIOD,
    POINTS,
    SceneBench,
    SpyModel,
    Vector,
    check_purity_and_reset,
    check_what_the_model_sees,
)

CLOUD = np.random.default_rng(0).normal(size=(POINTS, 3))


class Centroid(SpyModel):
    """The cloud's centroid."""

    @override
    def answer(self, cloud_W: Vector) -> NDArray[np.float64]:
        return np.asarray(cloud_W.mean(axis=0), dtype=float)


class Scene(SceneBench):
    """A predictor alone, its inputs fixed."""

    def __init__(self, com: NDArray[np.float64] | None = COM) -> None:
        model = Centroid()
        super().__init__(model, KeypointPredictor(model, POINTS, PERIOD), CLOUD, com)


def test_ports() -> None:
    assert ports(Scene().system) == {
        "in": {"point_cloud": 3 * POINTS, "goal": 2, "tool_pose": None, "object_com": 3},
        "out": {"keypoint": 3},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    check_purity_and_reset(Scene())


def test_the_model_sees_cloud_goal_com_and_hand() -> None:
    check_what_the_model_sees(Scene(), CLOUD)


def test_the_centre_of_mass_may_be_unknown() -> None:
    scene = Scene(com=None)
    scene.simulator.AdvanceTo(0.15)
    assert all(com is None for _, _, com, _ in scene.model.calls)
    np.testing.assert_allclose(scene.output("keypoint"), CLOUD.mean(axis=0))


def test_a_keypoint_is_there_at_once_and_held_for_one_policy_step() -> None:
    scene = Scene()
    scene.simulator.Initialize()
    np.testing.assert_allclose(scene.output("keypoint"), CLOUD.mean(axis=0))
    scene.simulator.AdvanceTo(0.01)
    asked = len(scene.model.calls)
    for time in (0.03, 0.06, 0.0999):
        scene.see(CLOUD + time)
        scene.simulator.AdvanceTo(time)
        np.testing.assert_allclose(scene.output("keypoint"), CLOUD.mean(axis=0))
    assert len(scene.model.calls) == asked
    scene.simulator.AdvanceTo(0.11)
    np.testing.assert_allclose(scene.output("keypoint"), (CLOUD + 0.0999).mean(axis=0))
    scene.simulator.AdvanceTo(2.05)
    assert len(scene.model.calls) == asked + 20


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_keypoint_that_is_not_finite_ends_the_simulation(bad: float) -> None:
    scene = Scene()
    scene.simulator.AdvanceTo(0.15)
    scene.see(np.where(np.arange(POINTS)[:, np.newaxis] == 3, bad, CLOUD))
    with pytest.raises(PolicyError, match=r"^keypoint is not finite$"):
        scene.simulator.AdvanceTo(0.45)
    assert scene.context.get_time() == pytest.approx(0.2)
    np.testing.assert_allclose(scene.output("keypoint"), CLOUD.mean(axis=0))
    scene.see(CLOUD + 1.0)
    scene.context.SetTime(0.0)
    scene.simulator.Initialize()
    np.testing.assert_allclose(scene.output("keypoint"), (CLOUD + 1.0).mean(axis=0))


def test_without_a_first_keypoint_there_is_no_simulation() -> None:
    scene = Scene()
    scene.see(np.full((POINTS, 3), np.nan))
    with pytest.raises(PolicyError, match=r"^keypoint is not finite$"):
        scene.simulator.Initialize()


def test_an_input_without_a_wire_is_named() -> None:
    predictor = KeypointPredictor(Centroid(), POINTS, PERIOD)
    with pytest.raises(RuntimeError, match="'tool_pose' is not connected"):
        predictor.predict(predictor.CreateDefaultContext())
