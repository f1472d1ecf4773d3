"""A varied object moves as its own mass, centre of mass, inertia and friction say."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialVelocity

from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import parse_scenario

GRAVITY = 9.81
INTEGRATORS = pytest.mark.parametrize("integrator", ["cenic", "discrete"])
STILL = SpatialVelocity(np.zeros(3), np.zeros(3))
ARM_ASIDE = np.array([1.5, 0.04, 0.0, -2.1, 0.0, 2.1, 0.0])
"""Held for the tenths of a second that a test takes."""


class VariedScene(EpisodeRunner):
    """The station of an episode with the arm aside and the object put anywhere."""

    def __init__(self, name: str, integrator: str, variation: dict[str, Any]) -> None:
        settings = {
            "policy": "expert",
            "episode": {"max_tilt_deg": 180.0, "max_height_change": 1.0},
            "object": {"name": name},
            # Short steps, since this is not about the integrators.
            "simulation": {"integrator": integrator, "max_step": 0.001},
            "variation": variation,
        }
        super().__init__(parse_scenario(repr(settings)))

    def start(self, episode: int, X_WO: RigidTransform, V_WO: SpatialVelocity) -> None:
        self.reset(episode)
        station = self.push.station
        context = station.plant.GetMyMutableContextFromRoot(self._context)
        station.plant.SetPositions(context, station.panda.instance, ARM_ASIDE)
        station.plant.SetFreeBodyPose(context, station.object_body, X_WO)
        self.throw(V_WO)

    def throw(self, V_WO: SpatialVelocity) -> None:
        station = self.push.station
        context = station.plant.GetMyMutableContextFromRoot(self._context)
        station.plant.SetFreeBodySpatialVelocity(context, station.object_body, V_WO)
        self._simulator.Initialize()

    def advance(self, duration: float) -> None:
        self._simulator.AdvanceTo(self._context.get_time() + duration)

    @property
    def varied(self) -> Any:
        return self._object

    @property
    def friction(self) -> float:
        """Drake's combination of object and table."""
        a, b = self._variation.object_friction, self._variation.table_friction
        return 2 * a * b / (a + b)

    def pose(self) -> RigidTransform:
        station = self.push.station
        context = station.plant.GetMyContextFromRoot(self._context)
        X_WO: RigidTransform = station.plant.EvalBodyPoseInWorld(context, station.object_body)
        return X_WO

    def velocity(self) -> SpatialVelocity:
        station = self.push.station
        context = station.plant.GetMyContextFromRoot(self._context)
        return station.plant.EvalBodySpatialVelocityInWorld(context, station.object_body)

    def com(self) -> NDArray[np.float64]:
        """p_WoOcm_W by the varied model."""
        return np.asarray(self.pose() @ self.varied.model.p_OoOcm_O)

    def angular_momentum(self) -> NDArray[np.float64]:
        """About the centre of mass, in W."""
        R_WO = self.pose().rotation().matrix()
        return np.asarray(R_WO @ self.varied.model.I_OOcm_O @ R_WO.T @ self.velocity().rotational())


@INTEGRATORS
@pytest.mark.parametrize("side", ["object_friction", "table_friction"])
@pytest.mark.parametrize("factor", [0.3, 0.5])
def test_sliding_decelerates_at_the_episodes_friction(
    integrator: str, side: str, factor: float
) -> None:
    scene = VariedScene("book", integrator, {side: [factor, factor]})
    height = scene.push.station.model.rest_height
    speed = 0.2
    scene.start(0, RigidTransform(np.array([0.1, -0.1, height])), STILL)
    scene.advance(0.1)
    scene.throw(SpatialVelocity(np.zeros(3), np.array([0.0, speed, 0.0])))
    expected = scene.friction * GRAVITY
    duration = 0.6 * speed / expected
    scene.advance(duration)
    found = (speed - scene.velocity().translational()[1]) / duration
    assert found == pytest.approx(expected, rel=0.06)


@INTEGRATORS
def test_a_tossed_object_turns_about_its_own_centre_of_mass(integrator: str) -> None:
    scene = VariedScene("can", integrator, {"mass": [0.5, 2.0], "com_shift": 0.015})
    X_WO = RigidTransform(RollPitchYaw(0.3, -0.2, 0.9), np.array([0.1, 0.0, 0.25]))
    w = np.array([3.0, 4.0, -2.0])
    scene.start(1, X_WO, SpatialVelocity(w, np.zeros(3)))
    assert np.hypot(*scene.varied.com_offset) > 0.01
    start, momentum = scene.com(), scene.angular_momentum()
    p_OoOcm_W = X_WO.rotation().matrix() @ scene.varied.model.p_OoOcm_O
    v_Wcm = np.cross(w, p_OoOcm_W)
    duration = 0.15
    scene.advance(duration)
    expected = start + duration * v_Wcm - np.array([0.0, 0.0, GRAVITY * duration**2 / 2])
    np.testing.assert_allclose(scene.com(), expected, atol=1.5e-3)
    error = np.linalg.norm(scene.angular_momentum() - momentum)
    assert error < 0.03 * np.linalg.norm(momentum)
    # With the uniform object's inertia it would not be conserved.
    moved, uniform = scene.varied.model.I_OOcm_O, scene.push.station.model.I_OOcm_O
    ratio = moved / moved[0, 0] - uniform / uniform[0, 0]
    assert np.abs(ratio).max() > 0.1


@INTEGRATORS
def test_a_shifted_object_stands_as_far_as_the_cap_lets_it(integrator: str) -> None:
    scene = VariedScene("bottle", integrator, {"com_shift": 0.1})
    height = scene.push.station.model.rest_height
    X_WO = RigidTransform(np.array([0.1, 0.0, height]))
    scene.start(2, X_WO, STILL)
    assert scene.varied.com_capped
    scene.advance(1.0)
    assert np.linalg.norm(scene.pose().translation() - X_WO.translation()) < 1e-3
