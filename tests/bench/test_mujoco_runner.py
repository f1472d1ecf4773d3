"""Episodes with MuJoCo as the engine."""

import numpy as np
import pytest

from keypush.bench.mujoco_runner import MujocoEpisodeRunner
from keypush.errors import UserError
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import EpisodeConfig, ObjectConfig, Scenario, SimulationConfig


def _scenario(max_steps: int = 300, integrator: str = "cenic") -> Scenario:
    return Scenario(
        policy="expert",
        object=ObjectConfig(name="block"),
        episode=EpisodeConfig(max_steps=max_steps),
        simulation=SimulationConfig(integrator=integrator),
    )


def test_the_expert_pushes_the_block_to_the_goal_as_in_drake() -> None:
    scenario = _scenario()
    ours, mujoco = (make(scenario).run(1).summary for make in (EpisodeRunner, MujocoEpisodeRunner))
    assert (ours["outcome"], mujoco["outcome"]) == ("success", "success")
    offset = np.subtract(ours["final_position"], mujoco["final_position"])  # type: ignore[call-overload]  # a summary's values are objects
    assert np.linalg.norm(offset) < 0.05
    assert abs(int(str(ours["steps"])) / int(str(mujoco["steps"])) - 1) < 0.25


def test_before_contact_the_arm_moves_as_in_the_reference() -> None:
    """Same commands, noise, PD gains, damping and inertia, in Drake at 1 ms and MuJoCo at 2 ms."""
    scenario = _scenario(max_steps=15, integrator="discrete")
    ours, mujoco = (
        np.asarray(make(scenario).run(1).rows["q"], dtype=float)
        for make in (EpisodeRunner, MujocoEpisodeRunner)
    )
    np.testing.assert_allclose(mujoco, ours, atol=5e-3)
    assert np.ptp(ours, axis=0).max() > 0.1


def test_an_episode_does_not_depend_on_those_before_it() -> None:
    runner, other = (MujocoEpisodeRunner(_scenario(max_steps=20)) for _ in range(2))
    runner.run(5)
    again, alone = runner.run(2), other.run(2)
    np.testing.assert_array_equal(
        np.asarray(again.summary["final_position"]), np.asarray(alone.summary["final_position"])
    )
    assert again.seconds == alone.seconds


def test_a_scenario_that_varies_the_object_is_refused() -> None:
    scenario = _scenario()
    scenario.variation.com_shift = 0.015
    with pytest.raises(UserError, match=r"^variation is set; allowed .* none, .*$"):
        MujocoEpisodeRunner(scenario)
