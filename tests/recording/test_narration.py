"""The outcome in plain words."""

import json
from pathlib import Path

import numpy as np
import pytest

from keypush.policies import POLICIES
from keypush.recording.narration import final_distance, narrate
from keypush.rollout.episode import EpisodeResult
from keypush.scenario import parse_scenario


def result(outcome: str, *, settled: bool = False) -> EpisodeResult:
    summary: dict[str, object] = {
        "success": outcome == "success",
        "settled_success": settled,
        "outcome": outcome,
        "steps": 42,
        "final_position": np.array([0.13, 0.04, 0.03]),
        "reason": "no answer" if outcome == "policy_failed" else "",
    }
    return EpisodeResult(summary, {"goal": np.array([[0.1, 0.0]])}, 5.5)


def test_distance_is_that_in_the_plane() -> None:
    assert final_distance(result("fell")) == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("outcome", "settled", "words"),
    [
        ("success", True, ["Goal reached", "at rest"]),
        ("success", False, ["Goal reached", "not held"]),
        ("toppled", False, ["not reached", "the lamp base toppled"]),
        ("fell", False, ["not reached", "fell off the table"]),
        ("timed_out", False, ["not reached", "time ran out"]),
        ("policy_failed", False, ["not reached", "the policy failed (no answer) after"]),
    ],
)
def test_outcome_names_cause_steps_time_and_distance(
    outcome: str, settled: bool, words: list[str]
) -> None:
    scenario = parse_scenario("{object: {name: lamp_base}}")
    told = narrate(scenario, result(outcome, settled=settled)).outcome
    for word in [*words, "42 policy steps", "4.2 s", "5.0 cm"]:
        assert word in told


def weights(folder: Path, *objects: str) -> Path:
    path = folder / "mine.safetensors"
    path.write_bytes(b"")
    path.with_suffix(".json").write_text(json.dumps({"data": {"objects": objects}}))
    return path


@pytest.mark.parametrize(
    ("name", "words"), [("can", "of its training set"), ("mug_2", "never saw")]
)
def test_the_title_says_whether_the_network_was_trained_on_the_object(
    name: str, words: str, tmp_path: Path
) -> None:
    path = weights(tmp_path, "can", "block")
    scenario = parse_scenario(f"{{object: {{name: {name}}}, predictor: {{weights: '{path}'}}}}")
    told = narrate(scenario, result("fell"))
    assert words in told.title
    assert "network" in told.policy


@pytest.mark.parametrize("policy", ["expert", "geometric", "centroid"])
def test_who_has_learned_nothing_has_seen_nothing(policy: str) -> None:
    told = narrate(parse_scenario(f"{{policy: {policy}}}"), result("fell"))
    assert told.title == "A Franka Panda pushes the mug."
    assert told.policy == f"Policy: {policy} ({POLICIES[policy].description})."
