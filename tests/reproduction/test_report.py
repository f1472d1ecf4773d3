"""The tables: the thesis' figures beside counts that were made up."""

import json
from pathlib import Path

import pyarrow as pa
import pytest

from keypush.evaluation.records import RECORDS
from keypush.evaluation.wilson import wilson_interval
from keypush.reproduction.plan import Plan
from keypush.reproduction.report import Reproduction, write_reproduction
from keypush.reproduction.throughput import Session
from tests.evaluation.test_records import record

PLAN = Plan(objects=("block", "mug", "can_2"), sizes=(1.0, 0.75), shifted=("block",), episodes=10)


def _episodes(successes: int, **fields: object) -> list[dict[str, object]]:
    return [
        record(
            success=number < successes,
            outcome="success" if number < successes else "toppled",
            episode=number,
            **fields,
        )
        for number in range(10)
    ]


def _records(policy: str) -> list[dict[str, object]]:
    shifted = {"object": "block", "com_shift": 0.015, "size_ratio": 1.0}
    return [
        *_episodes(8, policy=policy, object="block", size_ratio=1.0, keypoint_error=0.004),
        *_episodes(9, policy=policy, object="mug", size_ratio=1.0, keypoint_error=0.004),
        *_episodes(10, policy=policy, object="can_2", size_ratio=1.0, keypoint_error=0.004),
        *_episodes(6, policy=policy, object="block", size_ratio=0.75),
        *_episodes(4, policy=policy, object="mug", size_ratio=0.75),
        *_episodes(5, policy=policy, com_capped=True, **shifted),
    ]


@pytest.fixture
def written(tmp_path: Path) -> Path:
    policies = ["keypoint", "expert"]
    rows = [row for policy in policies for row in _records(policy)]
    found = Reproduction(
        plan=PLAN,
        policies=policies,
        left=["surface/size_1-shift_0-noise_0.005"],
        records=pa.Table.from_pylist(rows, schema=RECORDS),
        sessions={"keypoint": [Session(episodes=60, seconds=30.0, workers=2)], "expert": []},
        ablation=None,
    )
    write_reproduction(found, tmp_path)
    return tmp_path


def test_tables_have_the_thesis_figures_ours_interval_difference_and_number(written: Path) -> None:
    text = (written / "tables.md").read_text()
    sections = {part.split("\n", 1)[0]: part for part in text.split("\n## ")}
    low, high = (100 * end for end in wilson_interval(17, 20))
    trained = sections["Table 5.5: object sizes, training objects"]
    assert (
        f"| original | keypoint | 87.1 % | 85.0 % | {low:.1f} to {high:.1f} | -2.1 | 20 |"
        in trained
    )
    assert "| -25 % | keypoint | 80.9 % | 50.0 % |" in trained
    assert "| original | expert | - | 85.0 % |" in trained
    assert "+12.5" not in trained
    shifted = sections["Table 5.8: centre of mass shifted by 1.5 cm"]
    assert "| block, normal | keypoint | 88.9 % | 80.0 % |" in shifted
    assert (
        "| block, shifted | keypoint | 53.0 % | 50.0 % | 23.7 to 76.3 | -3.0 | 10 | 100.0 % |"
        in (shifted)
    )
    assert "| mug, normal | keypoint | 92.6 % | 90.0 % |" in shifted
    assert "mug, shifted" not in shifted
    assert "| original | keypoint | 82.7 % | 100.0 % |" in text
    assert (
        "| keypoint | 90.0 % | 0.0 % | 10.0 % | 0.0 % | 0.0 % | 0 | 0.00 | 0.00 | 4.0 | 30 |"
        in text
    )


def test_speed_is_told_apart(written: Path) -> None:
    assert "| keypoint | 60 | 30 | 2 | 2.00 |" in (written / "speed.md").read_text()
    for name in ("tables.md", "summary.json"):
        assert "second" not in (written / name).read_text()


def test_what_is_missing_is_said(written: Path) -> None:
    text = (written / "tables.md").read_text()
    assert " surface/size_1-shift_0-noise_0.005 is still to run." in text
    assert "2 of 16 `train` (block, mug); 1 of 6 `id` (can_2)" in text
    assert "Not run. `keypush ablate " in text


def test_the_summary_has_the_same_figures(written: Path) -> None:
    summary = json.loads((written / "summary.json").read_text())
    line = summary["tables"]["5.5"][0]
    assert (line["condition"], line["policy"], line["thesis"]) == ("original", "keypoint", 87.1)
    assert line["ours"]["successes"] == 17
    assert line["difference"] == pytest.approx(-2.1)
    assert summary["plan"]["objects"] == ["block", "mug", "can_2"]
