"""The Gymnasium environment: Gymnasium's own checks, seeds, episodes, mistakes, end."""

import gc
import warnings
import weakref
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env, data_equivalence

from keypush.dataset.features import FEATURES, cloud_feature
from keypush.environments import ENVIRONMENT_ID
from keypush.environments.configuration import resolve_scenario
from keypush.environments.push_env import PushEnv
from keypush.errors import UserError
from keypush.scenario import Scenario, dump_scenario

EXTRAS = ("state", "tool_pose", "object_pose")
ANY = np.array([0.03, -0.02, 0.01, 0.05, 0.0, -0.05])
SHORT = {"episode.max_steps": 3}


def _make(**arguments: Any) -> PushEnv:
    environment = gymnasium.make(ENVIRONMENT_ID, **arguments).unwrapped
    assert isinstance(environment, PushEnv)
    return environment


def _same(first: Any, second: Any) -> bool:
    return data_equivalence(first, second, exact=True)


@pytest.fixture(scope="module")
def environment() -> PushEnv:
    return PushEnv("block", extras=EXTRAS)


@pytest.mark.parametrize("action", ["residual", "keypoint"])
def test_gymnasium_finds_nothing_amiss(action: str) -> None:
    environment = gymnasium.make(ENVIRONMENT_ID, object="block", action=action)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Clips in metres and radians are what an action is; a wrapper can make [-1, 1] of them.
        warnings.filterwarnings("ignore", message=".*normalized space")
        warnings.filterwarnings("ignore", message=".*render")
        check_env(environment.unwrapped, skip_render_check=True)


def test_the_module_can_stand_in_the_name() -> None:
    environment = gymnasium.make(f"keypush.environments:{ENVIRONMENT_ID}", object="block")
    assert environment.spec is not None
    assert environment.spec.id == ENVIRONMENT_ID


def test_observations_are_fields_of_the_data_set(environment: PushEnv) -> None:
    observation, _ = environment.reset(seed=0)
    fields = {f.name.removeprefix("observation."): f for f in (*FEATURES, cloud_feature(512))}
    assert set(observation) == {"point_cloud", "com", "goal", "hand_state", *EXTRAS}
    for name, value in observation.items():
        assert value.shape == fields[name].shape
        assert value.dtype == fields[name].dtype
    assert observation in environment.observation_space


def test_the_same_seed_gives_the_same_episodes(environment: PushEnv) -> None:
    def play() -> list[Any]:
        seen: list[Any] = []
        for seed in (5, None):
            seen.append(environment.reset(seed=seed))
            seen.extend(environment.step(ANY) for _ in range(3))
        return seen

    first = play()
    environment.reset(seed=6)
    other = environment.step(ANY)
    assert _same(play(), first)
    assert not _same(other[0], first[1][0])
    assert not _same(first[0][0], first[4][0])


def test_episodes_are_counted_on_and_can_be_chosen(environment: PushEnv) -> None:
    _, info = environment.reset(seed=1)
    assert (info["seed"], info["episode_number"]) == (1, 0)
    second, info = environment.reset()
    assert info["episode_number"] == 1
    _, info = environment.reset(options={"episode": np.int64(7)})
    assert info["episode_number"] == 7
    _, info = environment.reset()
    assert info["episode_number"] == 8
    again, info = environment.reset(seed=1, options={"episode": 1})
    assert info["episode_number"] == 1
    assert _same(again, second)


def test_without_a_seed_one_is_drawn_and_told() -> None:
    first, second = PushEnv("block"), PushEnv("block")
    (seen, info), (_, other) = first.reset(), second.reset()
    assert info["seed"] != other["seed"]
    assert _same(second.reset(seed=info["seed"])[0], seen)


def test_objects_are_drawn_by_the_seed_or_chosen() -> None:
    environment = PushEnv(objects=["block", "book"], scenario=SHORT)
    drawn = [environment.reset(seed=0)[1]["object"]]
    drawn += [environment.reset()[1]["object"] for _ in range(7)]
    assert set(drawn) == {"block", "book"}
    assert environment.reset(seed=0, options={"episode": 3})[1]["object"] == drawn[3]
    assert environment.reset(options={"object": "can"})[1]["object"] == "can"


def test_the_time_is_out_after_the_scenarios_steps() -> None:
    environment = PushEnv("block", scenario={"episode": {"max_steps": 3}})
    environment.reset(seed=0)
    results = [environment.step(np.zeros(6)) for _ in range(3)]
    assert [r[2:4] for r in results] == [(False, False), (False, False), (False, True)]
    assert results[-1][4]["outcome"] == "timed_out"
    assert [r[4]["steps"] for r in results] == [1, 2, 3]
    with pytest.raises(ResetNeeded):
        environment.step(np.zeros(6))
    environment.reset()
    environment.step(np.zeros(6))


def test_actions_beyond_the_bounds_are_clipped(environment: PushEnv) -> None:
    high = np.repeat([0.06, 0.1], 3)
    environment.reset(seed=0)
    clipped = environment.step(high)
    environment.reset(seed=0)
    assert _same(environment.step(100 * high), clipped)


@pytest.mark.parametrize(
    ("action", "words"),
    [
        (np.zeros(5), r"shape \(5,\); allowed: \(6,\)"),
        (np.full(6, np.nan), "nan.*allowed: finite numbers"),
        ("left", "'left'; allowed: 6 numbers"),
        (np.zeros(6, dtype=complex), r"\+0\.j.*; allowed: 6 numbers"),
        ([10**400, 0, 0, 0, 0, 0], "000.*; allowed: 6 numbers"),
    ],
)
def test_an_action_that_is_none_is_refused(environment: PushEnv, action: Any, words: str) -> None:
    environment.reset(seed=0)
    with pytest.raises(UserError, match=words):
        environment.step(action)
    assert environment.step(np.zeros(6))[4]["steps"] == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"object": "teapot"}, "'teapot' is not there"),
        ({"objects": "teapot,block"}, "'teapot' is not there"),
        ({"object": 5}, "object is 5; allowed: .*block"),
        ({"object": ["block"]}, r"object is \['block'\]; allowed: .*block"),
        ({"objects": 5}, "objects is 5; allowed: names in a list, or in one text"),
        ({"objects": ["block", None]}, r"objects is \['block', None\]; allowed: names in a list"),
        ({"object": "block", "objects": "train"}, "both given"),
        ({"action": "torque"}, "action is 'torque'; allowed: residual, keypoint"),
        ({"extras": ["force"]}, "extras has 'force'; allowed: state"),
        ({"extras": "state"}, "extras is 'state'; allowed: names out of state"),
        ({"extras": None}, "extras is None; allowed: names out of state"),
        ({"extras": [["state"]]}, r"extras has \['state'\]; allowed: state"),
        ({"shaping": -1}, "shaping is -1"),
        ({"shaping": "a"}, "shaping is 'a'"),
        ({"discount": None}, "discount is None"),
        ({"shaping": float("nan")}, "shaping is nan"),
        ({"discount": 0}, "discount is 0"),
        ({"render_mode": "human"}, "render_mode is 'human'"),
        ({"scenario": {"noise.cloud_points": 3}}, r"noise\.cloud_points is 3"),
        ({"scenario": {"noise": 3, "noise.cloud_points": 30}}, "given twice"),
        ({"scenario": {"noise": {"clouds": 3}}}, r"noise\.clouds is unknown"),
        ({"scenario": {"seed": object()}}, "allowed: numbers, texts"),
        ({"scenario": {"noise.cloud_deviation": np.float64(1)}}, r"cloud_deviation is 1\.0; allow"),
        ({"scenario": "none.yaml"}, "cannot be read"),
        ({"scenario": 3}, "scenario is 3"),
    ],
)
def test_a_users_mistake_is_told(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(UserError, match=words):
        PushEnv(**arguments)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"options": {"epoch": 1}}, "'epoch' is unknown; allowed: episode, object"),
        ({"options": {"episode": -1}}, "episode is -1"),
        ({"options": {"episode": 1.5}}, "episode is 1.5"),
        ({"options": {"episode": 10**400}}, "allowed: a whole number from 0 to 9007199254740992"),
        ({"options": "abc"}, "options is 'abc'; allowed: a mapping, or None"),
        ({"options": {"object": "teapot"}}, "'teapot' is not there"),
        ({"options": {"object": None}}, "object is None; allowed: .*block"),
        ({"options": {"object": 5}}, "object is 5; allowed: .*block"),
        ({"seed": 2**60}, "seed is 1152921504606846976"),
    ],
)
def test_a_mistake_in_a_reset_is_told(
    environment: PushEnv, arguments: dict[str, Any], words: str
) -> None:
    with pytest.raises(UserError, match=words):
        environment.reset(**arguments)


def test_a_scenario_may_come_from_anywhere(tmp_path: Path) -> None:
    scenario = Scenario()
    scenario.episode.max_steps, scenario.noise.cloud_points = 3, 64
    path = tmp_path / "short.yaml"
    path.write_text(dump_scenario(scenario))
    fields = {"episode": {"max_steps": 3}, "noise.cloud_points": 64}
    seen = [PushEnv("block", scenario=s).reset(seed=2)[0] for s in (scenario, path, fields)]
    assert seen[0]["point_cloud"].shape == (64, 3)
    assert _same(seen[0], seen[1])
    assert _same(seen[0], seen[2])
    assert scenario.seed == 0, "the caller's scenario is the caller's own"


def test_numbers_of_numpy_are_numbers() -> None:
    scenario = resolve_scenario(
        {
            "seed": np.int64(3),
            "noise": {"cloud_deviation": np.float64(0), "cloud_points": np.uint16(64)},
            "episode.goal": [np.float32(0.125), 0],
            "robot.base_position": np.array([-0.5, 0.0, 0.25]),
            "planner.reaim": np.bool_(False),
            "object.name": np.str_("can"),
        }
    )
    expected = {
        "seed": 3,
        "noise": {"cloud_deviation": 0.0, "cloud_points": 64},
        "episode.goal": [0.125, 0],
        "robot.base_position": (-0.5, 0.0, 0.25),
        "planner.reaim": False,
        "object.name": "can",
    }
    assert scenario == resolve_scenario(expected)


def test_close_frees_the_diagrams() -> None:
    environment = PushEnv("block", action="keypoint")
    environment.reset(seed=0)
    environment.step(np.zeros(3))
    running = environment._running
    assert running is not None
    watched = weakref.ref(running.push.diagram)
    del running
    environment.close()
    gc.collect()
    assert watched() is None
    environment.close()


def test_a_page_plays_the_episode() -> None:
    environment = _make(object="block", render_mode="meshcat", scenario=SHORT)
    plain = PushEnv("block", scenario=SHORT)
    assert plain.render() is None
    assert plain.url is None
    assert environment.render() is None
    start, _ = environment.reset(seed=0)
    assert _same(plain.reset(seed=0)[0], start)
    # Watching changes nothing.
    assert _same(environment.step(ANY), plain.step(ANY))
    page = environment.render()
    assert page is not None
    assert "Pushing the block" in page
    assert str(environment.url).startswith("http://localhost:")
    environment.close()
    assert environment.url is None
