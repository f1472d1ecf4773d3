"""TorqueNoise: Gaussian torques, held for one policy step."""

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator

from keypush.systems.episode_seed import set_episode_seed
from keypush.systems.torque_noise import TorqueNoise
from tests.systems.contract import assert_pure, assert_resets, evaluate, ports

PERIOD, DEVIATION = 0.1, 0.03


def _run(seed: int, episode: int, times: list[float]) -> list[NDArray[np.float64]]:
    """The torques at some times."""
    noise = TorqueNoise(7, DEVIATION, PERIOD)
    simulator = Simulator(noise)
    context = simulator.get_mutable_context()
    set_episode_seed(context, seed, episode)
    torques = []
    for time in times:
        simulator.AdvanceTo(time)
        torques.append(np.array(evaluate(noise, "torque", context)))
    return torques


def test_ports() -> None:
    assert ports(TorqueNoise(7, DEVIATION, PERIOD)) == {"in": {}, "out": {"torque": 7}}


def test_outputs_are_pure_and_the_context_resets() -> None:
    noise = TorqueNoise(7, DEVIATION, PERIOD)
    simulator = Simulator(noise)
    simulator.AdvanceTo(0.25)
    context = simulator.get_mutable_context()
    assert_pure(noise, context)
    assert_resets(noise, context)


def test_a_torque_is_held_for_one_policy_step() -> None:
    times = [(k + share) * PERIOD for k in range(20) for share in (0.1, 0.5, 0.9)]
    torques = np.array(_run(0, 0, times)).reshape(20, 3, 7)
    np.testing.assert_array_equal(torques[:, 0], torques[:, 1])
    np.testing.assert_array_equal(torques[:, 0], torques[:, 2])
    assert len({row.tobytes() for row in torques[:, 0]}) == 20
    assert np.all(torques != 0)


def test_the_torques_have_the_given_size() -> None:
    torques = np.array(_run(0, 0, [(k + 0.5) * PERIOD for k in range(3000)]))
    count = len(torques)
    np.testing.assert_allclose(torques.mean(axis=0), 0, atol=4 * DEVIATION / np.sqrt(count))
    np.testing.assert_allclose(torques.std(axis=0), DEVIATION, rtol=4 / np.sqrt(2 * count))
    next_to_it = np.corrcoef(torques[1:].ravel(), torques[:-1].ravel())[0, 1]
    assert abs(next_to_it) < 4 / np.sqrt(7 * count)


def test_torques_follow_seed_episode_and_step() -> None:
    times = [0.05, 0.15]
    runs = {
        (seed, episode): np.concatenate(_run(seed, episode, times)).tobytes()
        for seed in (0, 1)
        for episode in (0, 1)
    }
    assert len(set(runs.values())) == 4
    assert np.concatenate(_run(1, 0, times)).tobytes() == runs[1, 0]
    # The second step's torque does not depend on whether the first was drawn.
    late = TorqueNoise(7, DEVIATION, PERIOD)
    simulator = Simulator(late)
    context = simulator.get_mutable_context()
    set_episode_seed(context, 1, 0)
    context.SetTime(0.1)
    simulator.Initialize()
    simulator.AdvanceTo(0.15)
    np.testing.assert_array_equal(evaluate(late, "torque", context), _run(1, 0, times)[1])
