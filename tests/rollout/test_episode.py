"""Episodes: the same bytes whatever ran before, and one row per policy step."""

import hashlib
from typing import Any

import numpy as np
import pytest
from pydrake.systems.framework import Context

from keypush.errors import UserError
from keypush.planning.plan_state import Stage
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.rollout.simulation import simulator_config
from keypush.rollout.start import StartSampler
from keypush.scenario import Scenario, parse_scenario
from keypush.systems.episode_logger import ROW_COLUMNS
from keypush.systems.episode_seed import SEED_PARAMETER
from keypush.systems.expert_planner import ExpertPlanner
from keypush.systems.point_cloud_sensor import PointCloudSensor
from keypush.systems.torque_noise import TorqueNoise

STEPS = 12


class OpenRunner(EpisodeRunner):
    """Shows its context."""

    @property
    def context(self) -> Context:
        return self._context


def _scenario(**changes: Any) -> Scenario:
    settings = {"policy": "expert", "object": {"name": "block"}, "episode": {"max_steps": STEPS}}
    return parse_scenario(repr({**settings, **changes}))


def _digest(result: EpisodeResult) -> str:
    digest = hashlib.sha256(repr(sorted(result.summary.items())).encode())
    for name, column in sorted(result.rows.items()):
        digest.update(name.encode() + column.tobytes())
    return digest.hexdigest()


@pytest.fixture(scope="module")
def runner() -> EpisodeRunner:
    return EpisodeRunner(_scenario())


def test_an_episode_does_not_depend_on_those_before_it(runner: EpisodeRunner) -> None:
    first = _digest(runner.run(3))
    other = _digest(runner.run(5))
    assert _digest(runner.run(3)) == first
    assert other != first
    assert _digest(EpisodeRunner(_scenario()).run(3)) == first


@pytest.mark.parametrize("policy", ["expert", "centroid"])
def test_every_policy_and_the_reset_heuristic_repeat_bit_for_bit(policy: str) -> None:
    scenario = _scenario(
        policy=policy,
        episode={"max_steps": 60},
        planner={"reset_period": 2},
        object={"name": "mug"},
    )
    runner = EpisodeRunner(scenario)
    first = _digest(runner.run(1))
    runner.run(0)
    assert _digest(runner.run(1)) == first


@pytest.mark.parametrize("integrator", ["cenic", "discrete"])
def test_both_integrators_repeat_bit_for_bit(integrator: str) -> None:
    scenario = _scenario(simulation={"integrator": integrator}, episode={"max_steps": 4})
    runner = EpisodeRunner(scenario)
    first = _digest(runner.run(3))
    runner.run(5)
    assert _digest(runner.run(3)) == first


def test_everything_that_draws_knows_seed_and_episode() -> None:
    runner = OpenRunner(_scenario(seed=7))
    drawing = [
        system
        for diagram in (runner.push.diagram, runner.push.station.diagram)
        for system in diagram.GetSystems()
        if isinstance(system, PointCloudSensor | TorqueNoise | ExpertPlanner)
    ]
    assert len(drawing) == 3
    runner.reset(5)
    for system in drawing:
        parameter = system.GetMyContextFromRoot(runner.context).get_numeric_parameter(
            SEED_PARAMETER
        )
        np.testing.assert_array_equal(parameter.value(), [7, 5])


def test_seeds_give_other_episodes(runner: EpisodeRunner) -> None:
    other = EpisodeRunner(_scenario(seed=1))
    assert _digest(other.run(3)) != _digest(runner.run(3))


def test_there_is_one_row_for_every_policy_step(runner: EpisodeRunner) -> None:
    result = runner.run(3)
    rows: dict[str, Any] = result.rows
    assert result.summary["steps"] == STEPS
    assert result.summary["outcome"] == "timed_out"
    assert result.summary["success"] is False
    assert result.seconds == pytest.approx(STEPS * 0.1)
    steps = rows["step"]
    np.testing.assert_array_equal(steps, np.arange(STEPS + 1))
    np.testing.assert_allclose(rows["time"], 0.1 * np.arange(STEPS + 1), atol=1e-9)
    for name, size in ROW_COLUMNS.items():
        shape = (STEPS + 1,) if name == "stage" else (STEPS + 1, size)
        assert rows[name].shape == shape
    for name, value in {"object": "block", "seed": 0, "episode": 3, "size_ratio": 1.0}.items():
        assert np.all(rows[name] == value)


def test_the_rows_begin_at_the_sampled_start(runner: EpisodeRunner) -> None:
    result = runner.run(3)
    rows: dict[str, Any] = result.rows
    start = StartSampler(runner.scenario, runner.push.station.model).sample(3)
    pose = rows["object_pose"][0]
    np.testing.assert_allclose(pose[4:], start.X_WO.translation(), atol=1e-12)
    np.testing.assert_allclose(rows["q"][0], start.q, atol=1e-12)
    np.testing.assert_array_equal(rows["v"][0], np.zeros(7))
    np.testing.assert_array_equal(rows["goal"], np.tile(start.goal, (STEPS + 1, 1)))
    # Nothing has touched the object yet.
    last = rows["object_pose"][-1]
    np.testing.assert_allclose(last, pose, atol=2e-4)
    np.testing.assert_array_equal(np.array(result.summary["final_position"]), last[4:])
    assert np.all(np.isnan(rows["contact_point"]))


def test_the_expert_takes_a_block_to_its_goal() -> None:
    """The best of three episodes: how often it succeeds is a matter of statistics."""
    runner = EpisodeRunner(_scenario(episode={"max_steps": 300}))
    results = [runner.run(episode) for episode in range(3)]
    won = next(r for r in results if r.summary["success"])
    rows: dict[str, Any] = won.rows
    touched = np.isfinite(rows["contact_point"][:, 0])
    assert touched.any()
    assert np.mean(rows["stage"][touched] == Stage.PUSH) > 0.5
    moved = np.linalg.norm(rows["object_pose"][-1, 4:6] - rows["object_pose"][0, 4:6])
    assert moved > 0.03
    at_goal = int(str(won.summary["steps"]))
    distance = np.linalg.norm(rows["object_pose"][:, 4:6] - rows["goal"], axis=1)
    assert distance[at_goal] <= runner.scenario.episode.goal_radius
    assert np.all(distance[:at_goal] > runner.scenario.episode.goal_radius)
    # The force on the object points along the push, not against it.
    ahead = rows["goal"] - rows["object_pose"][:, 4:6]
    assert np.mean(np.sum(ahead * rows["contact_force"][:, :2], axis=1)[touched]) > 0


def test_the_integrator_is_the_scenarios() -> None:
    config = simulator_config(_scenario(simulation={"accuracy": 0.02, "max_step": 0.03}).simulation)
    assert (config.integration_scheme, config.accuracy) == ("cenic", 0.02)
    assert config.max_step_size == 0.03
    assert config.use_error_control
    runner = EpisodeRunner(_scenario(simulation={"integrator": "discrete"}))
    assert runner.push.station.plant.time_step() == 1e-3


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"object": {"name": "teapot"}}, "'teapot'"),
        ({"policy": "surface", "predictor": {"weights": "none"}}, "policy surface: weights 'none'"),
    ],
)
def test_a_users_mistake_is_told_when_the_runner_is_built(
    changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(UserError, match=words):
        EpisodeRunner(_scenario(**changes))


def test_a_field_set_out_of_range_is_refused() -> None:
    scenario = _scenario()
    scenario.object.mass = float("nan")
    with pytest.raises(UserError, match=r"object\.mass is nan"):
        EpisodeRunner(scenario)


def test_a_settled_test_longer_than_the_policy_steps_left_is_waited_for() -> None:
    scenario = parse_scenario("{policy: expert, object: {name: plate}}")
    scenario.episode.max_steps, scenario.episode.settle_time = 80, 10.0
    result = EpisodeRunner(scenario).run(2)
    assert result.summary["success"]
    assert result.summary["settled_success"]
    assert result.seconds > 10.0
