"""The networks in NumPy give what PyTorch gives, from the raw cloud in W to the answer in W."""

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import torch
from scipy.special import erf

from keypush.learning.clips import Clips
from keypush.learning.eager import both_models, random_network
from keypush.learning.inference.ops import gelu, gelu_tanh
from keypush.networks.config import EncoderConfig, KeypointConfig, SurfaceConfig
from tests.learning.scenes import SMALL, make_cloud, make_hand

TOLERANCE = 1e-4
"""m; of the action, shares of its clips."""
THESIS = [
    KeypointConfig(
        encoder=EncoderConfig(patch_size=patch_size, layers=layers), heads=heads, use_com=use_com
    )
    for patch_size in (16, 32)
    for layers in (2, 3)
    for heads in (8, 16)
    for use_com in (True, False)
]
SURFACE = [SMALL, SurfaceConfig(), SurfaceConfig(use_com=True), SurfaceConfig(use_hand=False)]
SHARES = Clips(1.0, 1.0)
CASES = [
    *[("keypoint", config) for config in THESIS],
    *[("behavior_cloning", config) for config in THESIS[:2]],
    *[("surface_keypoint", config) for config in SURFACE],
]


@pytest.mark.parametrize(("kind", "config"), CASES)
def test_answers_are_those_of_torch(kind: str, config: Any) -> None:
    fast, eager = both_models(kind, random_network(kind, config, seed=3), SHARES)
    answers = []
    for seed in range(5):
        rng = np.random.default_rng(seed)
        cloud, hand = make_cloud(rng, 512), make_hand(rng)
        com = cloud.mean(axis=0) + np.array([0.01, 0.0, 0.0])
        scene = cloud, rng.uniform(-0.2, 0.2, 2), com, hand
        answers.append(fast.predict(*scene))
        assert answers[-1].dtype == np.float64
        np.testing.assert_allclose(answers[-1], eager.predict(*scene), rtol=0, atol=TOLERANCE)
    # Scenes tell answers apart by more than the tolerance.
    assert np.ptp(answers, axis=0).max() > 10 * TOLERANCE


@pytest.mark.parametrize("kind", ["keypoint", "behavior_cloning", "surface_keypoint"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_non_finite_input_gives_a_non_finite_answer(kind: str, bad: float) -> None:
    config = SMALL if kind == "surface_keypoint" else KeypointConfig()
    fast, _ = both_models(kind, random_network(kind, config), SHARES)
    rng = np.random.default_rng(6)
    cloud = make_cloud(rng)
    cloud[7, 1] = bad
    answer = fast.predict(cloud, np.array([0.1, 0.0]), np.zeros(3), make_hand(rng))
    assert not np.isfinite(answer).any()


def test_gelu_against_its_formulas() -> None:
    x = np.linspace(-30, 30, 20001, dtype=np.float32)
    exact = 0.5 * x.astype(float) * (1 + erf(x.astype(float) / np.sqrt(2)))
    np.testing.assert_allclose(gelu(x.copy()), exact, rtol=0, atol=5e-6)
    tanh = torch.nn.functional.gelu(torch.from_numpy(x), approximate="tanh").numpy()
    np.testing.assert_allclose(gelu_tanh(x.copy()), tanh, rtol=0, atol=5e-6)


@pytest.mark.parametrize("policy", ["expert", "surface_no_com"])
def test_an_episode_never_imports_torch(policy: str) -> None:
    code = f"""
import sys
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import parse_scenario
text = "{{policy: {policy}, episode: {{max_steps: 2}}}}"
assert EpisodeRunner(parse_scenario(text)).run(0).summary["steps"] == 2
print(sorted({{"torch", "lightning"}} & sys.modules.keys()))
"""
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, check=True, text=True
    )
    assert result.stdout == "[]\n"
