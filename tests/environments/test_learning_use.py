"""What users do with an environment: vectors of them, policies, the example of the docs."""

import re
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv
from gymnasium.wrappers import RecordEpisodeStatistics
from gymnasium.wrappers.vector import RecordEpisodeStatistics as VectorStatistics

from keypush.environments import ENVIRONMENT_ID
from keypush.environments.push_env import PushEnv
from keypush.planning.contact import finger_contact
from keypush.planning.push_frame import push_direction

ROOT = Path(__file__).resolve().parents[2]


def _make() -> gymnasium.Env[dict[str, np.ndarray], np.ndarray]:
    return gymnasium.make(ENVIRONMENT_ID, object="block", scenario={"episode.max_steps": 3})


def test_two_processes_step_as_one_alone_does() -> None:
    vector = AsyncVectorEnv([_make, _make], context="spawn")
    try:
        observations, info = vector.reset(seed=4)
        assert observations["point_cloud"].shape == (2, 512, 3)
        assert list(info["seed"]) == [4, 5]
        for _ in range(3):
            observations, rewards, ended, cut, info = vector.step(np.full((2, 6), 0.02))
        assert (list(rewards), list(ended), list(cut)) == ([0, 0], [False] * 2, [True] * 2)
        alone = _make()
        for index, seed in enumerate((4, 5)):
            alone.reset(seed=seed)
            for _ in range(3):
                seen = alone.step(np.full(6, 0.02))[0]
            for name, value in seen.items():
                np.testing.assert_array_equal(observations[name][index], value)
        # The next episode begins by itself.
        _, _, _, _, info = vector.step(np.full((2, 6), 0.02))
        assert list(info["episode_number"]) == [1, 1]
    finally:
        vector.close()


def test_wrappers_that_count_rewards_work() -> None:
    single = RecordEpisodeStatistics(_make())
    vector = VectorStatistics(SyncVectorEnv([_make, _make]))
    for environment, action in ((single, np.zeros(6)), (vector, np.zeros((2, 6)))):
        environment.reset(seed=0)
        for _ in range(3):
            info = environment.step(action)[4]
        assert np.all(np.asarray(info["episode"]["l"]) == 3)
        assert np.all(np.asarray(info["episode_number"]) == 0)
        environment.close()


@pytest.mark.parametrize("name", ["mug", "block"])
def test_the_contact_behind_the_centre_of_mass_reaches_the_goal(name: str) -> None:
    environment = PushEnv(name, action="keypoint", shaping=0.1)
    observation, info = environment.reset(seed=0, options={"episode": 1})
    ended = cut = False
    reward = 0.0
    while not (ended or cut):
        com, goal = (observation[key].astype(float) for key in ("com", "goal"))
        keypoint = finger_contact(observation["point_cloud"], com, push_direction(com, goal))
        observation, reward, ended, cut, info = environment.step(keypoint)
    assert info["outcome"] == "success"
    assert info["distance"] <= 0.05
    assert reward > 0.9


def test_the_example_of_the_docs_runs(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "gymnasium.md").read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", text, re.DOTALL)
    assert code
    told = subprocess.run(
        [sys.executable, "-c", code[1]], cwd=tmp_path, capture_output=True, text=True, check=True
    ).stdout
    assert "success" in told


def test_importing_the_package_loads_no_drake() -> None:
    code = "import sys, keypush.environments as e; print('pydrake' in sys.modules)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "False"


def test_without_gymnasium_the_extra_is_named() -> None:
    code = "import sys; sys.modules['gymnasium'] = None; import keypush.environments"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert told.returncode != 0
    assert "pip install keypush[gym]" in told.stderr
