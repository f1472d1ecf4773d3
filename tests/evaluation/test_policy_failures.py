"""Somebody's own policy through `evaluate`: failures are recorded with their reasons."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from keypush.cli.main import main
from keypush.errors import UserError
from keypush.evaluation.evaluate import evaluate, evaluation_report
from keypush.evaluation.records import read_records
from keypush.objects.library import make_object
from keypush.recording.narration import narrate
from keypush.recording.recorder import record_episode
from keypush.reporting.differences import find_differences
from keypush.reporting.episodes import gather_episodes
from keypush.reporting.markdown import render_markdown
from keypush.reporting.report import build_report
from keypush.reporting.runs import read_runs
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.job import Job
from keypush.rollout.provenance import provenance
from keypush.rollout.start import StartSampler
from keypush.scenario import Scenario, parse_scenario
from tests.rollout.short_scenarios import bytes_of

OBJECTS = ("plate", "can")
STEPS = 4
POLICY = """
import time
import numpy as np
from keypush.learning import own_policy

own_policy.ANSWER_SECONDS = 2.0
RAISES, WAITS, NOT_A_NUMBER = {goals}

class Moody:
    uses_com = False
    asked = 0

    def predict(self, cloud, goal, com, hand):
        if list(goal) == RAISES:
            raise ValueError("bad cloud")
        if list(goal) == WAITS:
            time.sleep(3600)
        if list(goal) == NOT_A_NUMBER:
            self.asked += 1
            if self.asked == 4:
                return np.full(3, np.nan)
        return cloud.mean(axis=0)
"""
SHORT = ["--set", f"episode.max_steps={STEPS}", "noise.cloud_points=64"]
EXAMPLE = str(Path(__file__).parents[2] / "scripts" / "own_policy.py")


def _scenario(policy: str) -> Scenario:
    return replace(
        parse_scenario(f"{{seed: 1000000, episode: {{max_steps: {STEPS}}}}}"), policy=policy
    )


def _goals(scenario: Scenario) -> list[list[float]]:
    """Goals of the plate's episodes 1 to 3: by these a policy can tell episodes apart."""
    sampler = StartSampler(scenario, make_object("plate", 1.0))
    return [list(map(float, sampler.sample(episode).goal)) for episode in (1, 2, 3)]


@pytest.fixture(scope="module")
def policy(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("own") / "moody.py"
    path.write_text(POLICY.format(goals=_goals(_scenario("centroid"))))
    return f"{path}:Moody"


@pytest.fixture(scope="module")
def job(policy: str) -> Job:
    return Job(scenario=_scenario(policy), objects=OBJECTS, episodes=4)


@pytest.fixture(scope="module")
def evaluated(job: Job, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("evaluated")
    evaluate([job], out, workers=1)
    return out


def _line(policy: str) -> int:
    lines = Path(policy.rpartition(":")[0]).read_text().splitlines()
    return next(i for i, line in enumerate(lines, 1) if "raise ValueError" in line)


def test_each_failure_is_recorded_and_the_run_goes_on(policy: str, evaluated: Path) -> None:
    records = [
        r for r in read_records(evaluated / "records.parquet").to_pylist() if r["object"] == "plate"
    ]
    assert {r["policy"] for r in records} == {"moody.py:Moody"}
    assert [(r["outcome"], r["reason"]) for r in records] == [
        ("timed_out", ""),
        ("policy_failed", f"ValueError: bad cloud (moody.py:{_line(policy)})"),
        ("policy_failed", "no answer within 2 s"),
        ("policy_failed", "keypoint is not finite"),
    ]
    assert [r["steps"] for r in records] == [STEPS, 0, 0, 2]  # one answer more at the start
    assert not any(r["success"] or r["settled_success"] for r in records)
    for record in records[1:3]:
        assert record["object_path"] == record["tool_path"] == 0.0
        assert record["final_x"] == pytest.approx(record["start_x"])
    rows = pq.read_table(evaluated / "rows" / "plate-000000.parquet")
    found = Counter(rows["episode"].to_pylist())
    assert found == {0: STEPS + 1, 1: 1, 2: 1, 3: 3}
    for name in ("object_pose", "tool_pose", "goal"):
        assert np.isfinite(np.array(rows[name].to_pylist())).all()


def test_any_number_of_workers_gives_the_same_bytes(
    job: Job, evaluated: Path, tmp_path: Path
) -> None:
    evaluate([job], tmp_path, workers=2)
    assert bytes_of(tmp_path) == bytes_of(evaluated)


def test_a_failure_leaves_no_trace_in_the_next_episode(
    policy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("keypush.learning.own_policy.ANSWER_SECONDS", 2.0)
    scenario = parse_scenario("{object: {name: plate}}", defaults=_scenario(policy))
    runner = EpisodeRunner(scenario)
    failed = runner.run(1)
    after, alone = runner.run(0), EpisodeRunner(scenario).run(0)
    for name, column in alone.rows.items():
        np.testing.assert_array_equal(after.rows[name], column)
    told = narrate(scenario, failed)
    assert "moody.py:Moody (a keypoint model of your own" in told.policy
    assert "the policy failed (ValueError: bad cloud (moody.py:" in told.outcome


def test_a_recording_of_an_episode_without_an_answer_shows_no_keypoint(policy: str) -> None:
    scenario = parse_scenario("{object: {name: plate}}", defaults=_scenario(policy))
    recording = record_episode(scenario, 1)
    assert len(recording.result.rows["time"]) == 1
    assert "ValueError: bad cloud (moody.py:" in recording.html
    assert "keypoint and direction" not in recording.html


def test_summary_and_report_tell_the_reasons(job: Job, evaluated: Path) -> None:
    records = read_records(evaluated / "records.parquet")
    report = evaluation_report(job.scenario, [job], records)
    assert report["policy"] == "moody.py:Moody"
    assert report["objects"]["plate"]["failures"] == {"policy_failed": 3, "timed_out": 1}
    assert report["objects"]["plate"]["reasons"]["no answer within 2 s"] == 1
    assert sum(report["reasons"].values()) == report["failures"]["policy_failed"]
    table = read_runs([evaluated])
    text = render_markdown(build_report(gather_episodes(table), find_differences(table)))
    assert "- moody.py:Moody: a keypoint model of your own" in text
    assert "| policy failed |" in text
    number = report["reasons"]["no answer within 2 s"]
    assert f"| moody.py:Moody | no answer within 2 s | {number} |" in text
    assert "caution" not in text


def test_an_edited_file_is_not_mixed_with_earlier_episodes(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(Path(EXAMPLE).read_text())
    arguments = ["evaluate", "--policy", f"{path}:RearPoint", "--objects", "plate", "--episodes",
                 "1", "--workers", "1", *SHORT, "--out", str(tmp_path / "out")]  # fmt: skip
    assert main(arguments) == 0
    assert main(arguments) == 0
    path.write_text(path.read_text() + "\n")
    assert main(arguments) == 2


def test_the_digest_is_that_of_the_file_and_mistakes_are_told_first() -> None:
    scenario = _scenario(f"{EXAMPLE}:RearPoint")
    assert len(provenance(scenario, ["plate"])["policy_sha256"]) == 64
    with pytest.raises(UserError, match="has no class or function FrontPoint"):
        provenance(_scenario(f"{EXAMPLE}:FrontPoint"), ["plate"])
    assert "policy_sha256" not in provenance(_scenario("centroid"), ["plate"])


def test_the_example_is_evaluated_and_is_on_a_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "rear"
    assert main(["evaluate", "--policy", f"{EXAMPLE}:RearPoint", "--objects", "mug", "--episodes",
                 "2", "--workers", "1", "--out", str(out)]) == 0  # fmt: skip
    assert "own_policy.py:RearPoint, scenario seed 1000000" in capsys.readouterr().out
    summary: dict[str, Any] = json.loads((out / "summary.json").read_text())
    assert summary["policy"] == "own_policy.py:RearPoint"
    assert summary["successes"] == 2
    page = tmp_path / "page.html"
    assert main(["report", str(out), "--out", str(page)]) == 0
    assert "own_policy.py:RearPoint" in page.read_text()
