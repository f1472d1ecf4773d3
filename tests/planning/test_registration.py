"""register_rotation: exact without noise, and as noisy as it says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RollPitchYaw

from keypush.planning.registration import register_rotation

ANGLES = st.floats(-3.0, 3.0)


def _points(count: int = 50, radius: float = 0.04) -> np.ndarray:
    return radius * np.random.default_rng(2).normal(size=(count, 3))


@given(roll=ANGLES, pitch=st.floats(-1.5, 1.5), yaw=ANGLES, shift=st.floats(-1.0, 1.0))
def test_a_moved_body_is_found_again(roll: float, pitch: float, yaw: float, shift: float) -> None:
    X = RigidTransform(RollPitchYaw(roll, pitch, yaw), np.array([shift, -shift, 0.3]))
    p_WP = _points() + np.array([0.1, 0.0, 0.2])
    found = register_rotation(p_WP, (X @ p_WP.T).T)
    assert found.IsNearlyEqualTo(X.rotation(), 1e-9)


def test_a_flat_body_is_turned_and_not_reflected() -> None:
    p_WP = _points() * np.array([1.0, 1.0, 0.0])
    turn = RollPitchYaw(0.1, -0.05, 2.0).ToRotationMatrix()
    assert register_rotation(p_WP, (turn @ p_WP.T).T).IsNearlyEqualTo(turn, 1e-9)


def test_noise_turns_it_as_much_as_documented() -> None:
    p_WP, noise = _points(512), 0.005
    generator = np.random.default_rng(0)
    found = [
        register_rotation(p_WP, p_WP + generator.normal(scale=noise, size=p_WP.shape)).matrix()
        for _ in range(400)
    ]
    centred = p_WP - p_WP.mean(axis=0)
    for axis, (i, j) in enumerate([(2, 1), (0, 2), (1, 0)]):
        angles = [R[i, j] for R in found]
        r = np.sqrt(np.mean(np.sum(np.delete(centred, axis, axis=1) ** 2, axis=1)))
        assert np.std(angles) == pytest.approx(noise / (r * np.sqrt(512)), rel=0.15)
        assert np.mean(angles) == pytest.approx(0.0, abs=5e-4)
