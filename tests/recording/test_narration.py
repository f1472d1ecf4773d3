"""The outcome in plain words."""

import numpy as np
import pytest

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
    ],
)
def test_outcome_names_cause_steps_time_and_distance(
    outcome: str, settled: bool, words: list[str]
) -> None:
    scenario = parse_scenario("{object: {name: lamp_base}}")
    told = narrate(scenario, result(outcome, settled=settled)).outcome
    for word in [*words, "42 policy steps", "4.2 s", "5.0 cm"]:
        assert word in told


def test_title_says_whether_the_shape_was_trained_on_and_policy_who_drove() -> None:
    unseen = narrate(parse_scenario("{policy: expert, object: {name: mug_2}}"), result("fell"))
    seen = narrate(parse_scenario("{policy: centroid, object: {name: can}}"), result("fell"))
    assert "never seen" in unseen.title
    assert "of the training set" in seen.title
    assert "expert" in unseen.policy
    assert "centroid" in seen.policy
