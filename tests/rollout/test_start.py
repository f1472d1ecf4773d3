"""How episodes start: every constraint holds for every shape, and seeds decide."""

import math
from dataclasses import replace

import numpy as np
import pytest

from keypush.control.arm_kinematics import ArmKinematics
from keypush.errors import UserError
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import make_object
from keypush.robot.hand_shape import PALM
from keypush.rollout.start import EpisodeStart, StartSampler, reachable_half_extents
from keypush.scenario import EpisodeConfig, ObjectConfig, RobotConfig, Scenario, TableConfig

DRAWS = 15


def _sampler(
    name: str, episode: EpisodeConfig | None = None, seed: int = 0, size_ratio: float = 1.0
) -> StartSampler:
    scenario = Scenario(
        seed=seed, object=ObjectConfig(name=name), episode=episode or EpisodeConfig()
    )
    return StartSampler(scenario, make_object(name, size_ratio))


def _bytes(start: EpisodeStart) -> bytes:
    data: bytes = start.X_WO.GetAsMatrix34().tobytes()
    return data + start.goal.tobytes() + start.q.tobytes()


@pytest.mark.parametrize("size_ratio", [1.0, 1.25])
@pytest.mark.parametrize("name", catalogue_names())
def test_every_start_keeps_the_scenarios_distances(name: str, size_ratio: float) -> None:
    sampler, model = _sampler(name, size_ratio=size_ratio), make_object(name, size_ratio)
    table, robot, config = TableConfig(), RobotConfig(), EpisodeConfig()
    arm = ArmKinematics(robot)
    half_table = np.array([table.length, table.width]) / 2
    for episode in range(DRAWS):
        start = sampler.sample(episode)
        p_WO, R_WO = start.X_WO.translation(), start.X_WO.rotation().matrix()
        p_WV = model.vertices @ R_WO.T + p_WO
        # The object stands upright on the table, all of it, in the reachable part.
        np.testing.assert_allclose(R_WO[2], [0.0, 0.0, 1.0], atol=1e-12)
        assert p_WV[:, 2].min() == pytest.approx(0.0, abs=1e-9)
        assert np.all(np.abs(p_WV[:, :2]) <= half_table)
        assert np.all(np.abs(p_WO[:2]) <= table.reachable * half_table)
        assert np.all(np.abs(start.goal) <= table.reachable * half_table)
        assert math.dist(start.goal, p_WO[:2]) >= config.goal_min_distance
        p_WE = arm.tool_pose(start.q).translation()
        assert p_WE[2] >= robot.start_tool_height
        assert math.dist(p_WE, p_WO) >= robot.start_object_distance
        p_EV = (p_WV - p_WE) @ arm.tool_pose(start.q).rotation().matrix()
        assert PALM.distance(p_EV) > 0.005
        assert np.all((start.q >= arm.limits.lower) & (start.q <= arm.limits.upper))


def test_starts_are_spread_over_what_is_allowed() -> None:
    sampler, robot = _sampler("can"), RobotConfig()
    starts = [sampler.sample(episode) for episode in range(200)]
    half = reachable_half_extents(TableConfig())
    for points in ([s.X_WO.translation()[:2] for s in starts], [s.goal for s in starts]):
        quadrants = {(x > 0, y > 0) for x, y in points}
        assert len(quadrants) == 4
        assert np.all(np.abs(points).max(axis=0) > 0.9 * half)
    yaw = [math.atan2(*s.X_WO.rotation().matrix()[[1, 0], 0]) for s in starts]
    counts, _ = np.histogram(yaw, bins=8, range=(-np.pi, np.pi))
    # 25 expected in each; four standard deviations of a binomial draw.
    assert np.all(np.abs(counts - 25) < 4 * np.sqrt(200 * 7 / 64))
    q = np.array([s.q for s in starts])
    box = np.array(robot.start_upper) - np.array(robot.start_lower)
    outside = np.maximum(np.array(robot.start_lower) - q, q - np.array(robot.start_upper))
    assert outside.max() < 5 * robot.start_deviation
    assert np.all(np.ptp(q, axis=0) > 0.7 * box)


def test_a_start_depends_on_seed_and_episode_alone() -> None:
    sampler = _sampler("mug")
    starts = [_bytes(sampler.sample(episode)) for episode in range(20)]
    assert len(set(starts)) == 20
    again = _sampler("mug")
    assert [_bytes(again.sample(episode)) for episode in reversed(range(20))] == starts[::-1]
    other = _sampler("mug", seed=1)
    assert not set(starts) & {_bytes(other.sample(episode)) for episode in range(20)}


def test_a_given_goal_is_kept() -> None:
    goal = [0.12, -0.15]
    sampler = _sampler("block", EpisodeConfig(goal=goal))
    places = set()
    for episode in range(50):
        start = sampler.sample(episode)
        np.testing.assert_array_equal(start.goal, goal)
        assert math.dist(goal, start.X_WO.translation()[:2]) >= EpisodeConfig().goal_min_distance
        places.add(start.X_WO.translation().tobytes())
    assert len(places) == 50


@pytest.mark.parametrize("goal", [None, [0.0, 0.0]])
def test_a_goal_that_cannot_be_that_far_is_the_users_mistake(goal: list[float] | None) -> None:
    sampler = _sampler("block", EpisodeConfig(goal=goal, goal_min_distance=1.0))
    with pytest.raises(UserError, match=r"^episode\.goal_min_distance is 1 with goal .*'block'"):
        sampler.sample(0)


def test_an_arm_that_cannot_start_high_enough_is_the_users_mistake() -> None:
    scenario = Scenario(robot=RobotConfig(start_tool_height=1.0))
    sampler = StartSampler(scenario, make_object("block"))
    with pytest.raises(UserError, match=r"^robot\.start_lower .* 1 m above the table"):
        sampler.sample(0)


def test_starts_that_the_arm_cannot_make_are_drawn_again_and_counted() -> None:
    starts = [_sampler("can").sample(episode) for episode in range(100)]
    redrawn = [start.redrawn for start in starts]
    assert 0 < sum(redrawn) < 40
    # The far edge, towards the robot: seldom within reach.
    pulled = [s for s in starts if s.X_WO.translation()[0] > 0.14 and s.goal[0] < 0.0]
    assert len(pulled) < 5


def test_the_planner_does_not_change_where_episodes_start() -> None:
    plain = Scenario(object=ObjectConfig(name="can"))
    other = replace(plain, planner=replace(plain.planner, pitch_deg=80.0, wrist_yaw_deg=0.0))
    model = make_object("can")
    for episode in range(10):
        first, second = (StartSampler(s, model).sample(episode) for s in (plain, other))
        assert _bytes(first) == _bytes(second)


def test_an_arm_that_reaches_no_start_is_the_users_mistake() -> None:
    scenario = Scenario(table=TableConfig(length=5.0, width=5.0, reachable=1.0))
    scenario.episode.goal = [2.4, 0.0]
    sampler = StartSampler(scenario, make_object("block"))
    with pytest.raises(UserError, match=r"^the arm reaches none of \d+ starts of 'block'"):
        sampler.sample(0)
