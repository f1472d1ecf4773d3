"""UprightEstimator: the tilt of an object, from its noisy clouds alone."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.analysis import Simulator

from keypush.systems.upright_estimator import REST_SECONDS, UprightEstimator
from tests.systems.contract import assert_pure, assert_resets, ports

PERIOD, POINTS, NOISE = 0.1, 512, 0.005
REST_STEPS = round(REST_SECONDS / PERIOD)
P_OP = np.random.default_rng(1).uniform(-0.05, 0.05, size=(POINTS, 3))


class Scene:
    """The estimator alone, looking at an object that is moved by hand."""

    def __init__(self, noise: float = NOISE) -> None:
        self.system = UprightEstimator(POINTS, PERIOD)
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self._noise, self._generator = noise, np.random.default_rng(3)
        self.steps = 0
        self.show()
        self.simulator.Initialize()

    def show(self, tilt_deg: float = 0.0, yaw: float = 0.0, x: float = 0.0) -> None:
        """Tilts the object about Wx after it was turned about the vertical, and moves it."""
        turn = RollPitchYaw(np.deg2rad(tilt_deg), 0.0, 0.0).ToRotationMatrix()
        X_WO = RigidTransform(turn, np.array([x, 0.0, 0.05])) @ RigidTransform(
            RollPitchYaw(0.0, 0.0, yaw), np.zeros(3)
        )
        p_WP = (X_WO @ P_OP.T).T + self._generator.normal(scale=self._noise, size=P_OP.shape)
        self.system.GetInputPort("point_cloud").FixValue(self.context, p_WP.ravel())

    def step(self, **where: float) -> float:
        """Shows the object, reads its tilt in degrees, and lets a policy step pass."""
        self.show(**where)
        tilt = self.tilt_deg
        self.steps += 1
        self.simulator.AdvanceTo((self.steps - 0.5) * PERIOD)
        return tilt

    def rest(self) -> None:
        for _ in range(REST_STEPS):
            self.step()

    @property
    def up(self) -> NDArray[np.float64]:
        return np.array(self.system.GetOutputPort("object_up").Eval(self.context))

    @property
    def tilt_deg(self) -> float:
        return float(np.rad2deg(np.arccos(np.clip(self.up[2], -1.0, 1.0))))


def test_ports() -> None:
    assert ports(UprightEstimator(POINTS, PERIOD)) == {
        "in": {"point_cloud": 3 * POINTS},
        "out": {"object_up": 3},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    scene = Scene()
    scene.rest()
    scene.step(tilt_deg=3.0)
    assert_pure(scene.system, scene.context)
    assert_resets(scene.system, scene.context)


def test_an_object_at_rest_is_upright_within_its_noise() -> None:
    scene = Scene()
    scene.rest()
    tilts = [scene.step() for _ in range(60)]
    assert np.mean(tilts) < 0.4
    assert max(tilts) < 1.0


def test_nothing_is_said_before_the_object_at_rest_is_known() -> None:
    scene = Scene()
    for _ in range(REST_STEPS - 1):
        scene.step(tilt_deg=10.0)
        np.testing.assert_array_equal(scene.up, [0.0, 0.0, 1.0])


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_a_tilt_is_seen_within_three_steps_however_the_object_turned(yaw: float) -> None:
    scene = Scene(noise=0.0)
    scene.rest()
    scene.step(yaw=yaw, x=0.2)
    tilts = [scene.step(tilt_deg=4.0, yaw=yaw, x=0.2) for _ in range(3)]
    assert tilts == pytest.approx([2.0, 3.0, 3.5], abs=0.01)
    assert scene.up == pytest.approx([0.0, -np.sin(np.deg2rad(3.75)), 0.998], abs=1e-3)


def test_what_is_seen_within_a_policy_step_is_not_remembered() -> None:
    scene = Scene(noise=0.0)
    scene.rest()
    scene.show(tilt_deg=8.0)
    assert scene.tilt_deg == pytest.approx(4.0, abs=0.01)
    scene.show()
    assert scene.tilt_deg == pytest.approx(0.0, abs=0.01)
