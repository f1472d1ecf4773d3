"""PointCloudSensor: surface points in W, with noise of the given size."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.framework import Context

from keypush.systems.episode_seed import set_episode_seed
from keypush.systems.point_cloud_sensor import PointCloudSensor
from tests.systems.contract import assert_pure, assert_resets, evaluate, ports

PERIOD, DEVIATION = 0.1, 0.005
POINTS = np.random.default_rng(0).uniform(-0.05, 0.05, size=(512, 3))
X_WO = RigidTransform(RollPitchYaw(0.3, -0.2, 2.0), np.array([0.1, -0.05, 0.04]))
X_WMoved = RigidTransform(RollPitchYaw(-0.1, 0.5, -1.0), np.array([-0.1, 0.02, 0.3]))


def _sensor(deviation: float = DEVIATION) -> tuple[PointCloudSensor, Context]:
    sensor = PointCloudSensor(POINTS, deviation, PERIOD)
    context = sensor.CreateDefaultContext()
    sensor.GetInputPort("object_pose").FixValue(context, X_WO)
    return sensor, context


def _exact(pose: RigidTransform) -> NDArray[np.float64]:
    return np.array([pose @ p for p in POINTS])


def _cloud(
    sensor: PointCloudSensor, context: Context, time: float = 0.0, pose: RigidTransform = X_WO
) -> NDArray[np.float64]:
    context.SetTime(time)
    sensor.GetInputPort("object_pose").FixValue(context, pose)
    value = evaluate(sensor, "point_cloud", context)
    return np.array(value).reshape(-1, 3)


def test_ports() -> None:
    sensor, _ = _sensor()
    assert ports(sensor) == {"in": {"object_pose": None}, "out": {"point_cloud": 1536}}


def test_outputs_are_pure_and_the_context_resets() -> None:
    sensor, context = _sensor()
    set_episode_seed(context, 3, 4)
    context.SetTime(1.23)
    assert_pure(sensor, context)
    assert_resets(sensor, context)


def test_without_noise_the_cloud_is_the_surface() -> None:
    sensor, context = _sensor(0.0)
    np.testing.assert_allclose(_cloud(sensor, context), _exact(X_WO), atol=1e-15)


def test_the_noise_has_the_given_size_in_every_coordinate() -> None:
    sensor, context = _sensor()
    clean = _exact(X_WO)
    noise = np.array([_cloud(sensor, context, (k + 0.5) * PERIOD) - clean for k in range(100)])
    assert np.all(np.isfinite(noise))
    count = noise[..., 0].size
    # Four standard errors of mean and of standard deviation.
    np.testing.assert_allclose(noise.mean(axis=(0, 1)), 0, atol=4 * DEVIATION / np.sqrt(count))
    np.testing.assert_allclose(noise.std(axis=(0, 1)), DEVIATION, rtol=4 / np.sqrt(2 * count))
    correlation = np.corrcoef(noise.reshape(-1, 3).T)
    np.testing.assert_allclose(correlation, np.eye(3), atol=4 / np.sqrt(count))
    assert abs(np.corrcoef(noise[0].ravel(), noise[1].ravel())[0, 1]) < 4 / np.sqrt(1536)


@pytest.mark.parametrize("step", [0, 1, 3, 7, 299])
def test_within_a_policy_step_the_noise_does_not_change(step: int) -> None:
    sensor, context = _sensor()
    start = step * PERIOD
    noise = _cloud(sensor, context, start) - _exact(X_WO)
    for later in (0.01, 0.05, 0.0999):
        moved = _cloud(sensor, context, start + later, X_WMoved) - _exact(X_WMoved)
        np.testing.assert_allclose(moved, noise, atol=1e-15)
    other = _cloud(sensor, context, start + PERIOD) - _exact(X_WO)
    assert np.abs(other - noise).max() > DEVIATION


def test_the_cloud_follows_seed_episode_and_step() -> None:
    clouds = set()
    for seed in (0, 1):
        for episode in (0, 1):
            for time in (0.0, 0.1):
                sensor, context = _sensor()
                set_episode_seed(context, seed, episode)
                cloud = _cloud(sensor, context, time).tobytes()
                assert _cloud(sensor, context, time).tobytes() == cloud
                clouds.add(cloud)
    assert len(clouds) == 8
