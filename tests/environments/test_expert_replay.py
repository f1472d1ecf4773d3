"""Actions out of keypush's own episodes lead to these episodes, bit for bit."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from keypush.dataset.clouds import episode_clouds
from keypush.dataset.poses import hand_states
from keypush.environments.push_env import PushEnv
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.scenario import Scenario, parse_scenario

VARIED = {"mass": [0.8, 1.2], "com_shift": 0.01, "object_friction": [0.8, 1.2]}
SEED, EPISODE = 3, 4


def _run(**settings: Any) -> tuple[Scenario, EpisodeResult]:
    scenario = parse_scenario(repr({"seed": SEED, **settings}))
    return scenario, EpisodeRunner(scenario).run(EPISODE)


def _replay(environment: PushEnv, actions: np.ndarray[Any, Any]) -> dict[str, Any]:
    observation, info = environment.reset(seed=SEED, options={"episode": EPISODE})
    seen, rewards = [observation], []
    for action in actions:
        observation, reward, ended, cut, info = environment.step(action)
        seen.append(observation)
        rewards.append(reward)
        if ended or cut:
            break
    columns = {name: np.array([o[name] for o in seen]) for name in observation}
    return {**columns, "reward": np.array(rewards), "info": info, "ended": ended, "cut": cut}


def _assert_the_same(replayed: dict[str, Any], scenario: Scenario, result: EpisodeResult) -> None:
    told, count = result.summary, int(str(result.summary["steps"])) + 1
    rows = {name: column[:count] for name, column in result.rows.items()}
    assert replayed["info"]["steps"] == told["steps"]
    assert replayed["info"]["outcome"] == told["outcome"]
    assert replayed["ended"] == (told["outcome"] != "timed_out")
    assert replayed["cut"] == (told["outcome"] == "timed_out")
    clouds = episode_clouds(scenario.noise, told, np.asarray(rows["object_pose"], dtype=float))
    expected = {
        "object_pose": rows["object_pose"],
        "com": rows["com"],
        "goal": rows["goal"],
        "tool_pose": rows["tool_pose"],
        "hand_state": hand_states(np.asarray(rows["tool_pose"], dtype=float)),
        "state": np.hstack([rows["q"], rows["v"]]),
        "point_cloud": clouds,
    }
    for name, column in expected.items():
        exact = name != "hand_state"  # a rotation by way of a quaternion has other bits
        wanted = np.asarray(column).astype(replayed[name].dtype)
        np.testing.assert_allclose(
            replayed[name], wanted, rtol=0, atol=0 if exact else 1e-6, err_msg=name
        )
    success = float(told["outcome"] == "success")
    np.testing.assert_array_equal(replayed["reward"][:-1], 0.0)
    assert replayed["reward"][-1] == success


def _environment(action: str, settings: dict[str, Any]) -> PushEnv:
    extras = ("state", "tool_pose", "object_pose")
    return PushEnv(scenario=settings, action=action, extras=extras)


# A row's action and target were decided in the step before it.
_ANSWERS: dict[str, Callable[[EpisodeResult], np.ndarray[Any, Any]]] = {
    "residual": lambda result: result.rows["action"][1:],
    "keypoint": lambda result: result.rows["target"][1:],
}


@pytest.mark.parametrize(
    ("action", "policy", "outcome"),
    [("residual", "expert", "success"), ("keypoint", "centroid", "toppled")],
)
@pytest.mark.parametrize(
    "settings",
    [{"object": {"name": "mug"}}, {"object": {"name": "block"}, "variation": VARIED}],
    ids=["mug", "varied block"],
)
def test_a_logged_episode_comes_again(
    action: str, policy: str, outcome: str, settings: dict[str, Any]
) -> None:
    scenario, result = _run(policy=policy, **settings)
    assert result.summary["outcome"] == outcome
    touched = np.isfinite(np.asarray(result.rows["contact_point"], dtype=float)[:, 0])
    assert touched.any(), "an episode without contact would show little"
    replayed = _replay(_environment(action, settings), _ANSWERS[action](result))
    _assert_the_same(replayed, scenario, result)


def test_it_comes_again_with_the_discrete_model_and_another_size() -> None:
    settings = {
        "object": {"name": "block"},
        "variation": {"size": [0.8, 1.2]},
        "simulation": {"integrator": "discrete", "discrete_period": 0.005},
        "episode": {"max_steps": 90},
    }
    scenario, result = _run(policy="expert", **settings)
    assert result.summary["size_ratio"] != 1.0
    replayed = _replay(_environment("residual", settings), _ANSWERS["residual"](result))
    _assert_the_same(replayed, scenario, result)
