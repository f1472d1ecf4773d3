"""`keypush reproduce`: a small plan from its start to its tables, stopped and gone on with."""

import json
from pathlib import Path

import pytest

from keypush.cli.main import main
from keypush.evaluation.records import read_records
from keypush.reproduction.plan import Plan
from keypush.reproduction.reproduce import reproduce

PLAN = Plan(objects=("can_2",), sizes=(0.75,), shifted=("block",), episodes=1)


def test_a_small_plan_from_its_start_to_its_tables(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    reproduce(PLAN, ["geometric"], tmp_path, workers=1)
    assert "2 of 2 episodes to run for geometric: about 2 s" in capsys.readouterr().err
    assert {path.name for path in tmp_path.iterdir()} == {
        "geometric", "records.parquet", "summary.json", "tables.md",
    }  # fmt: skip
    records = read_records(tmp_path / "records.parquet")
    for record in records.to_pylist():
        file = f"{record['object']}-000000.parquet"
        assert (tmp_path / record["folder"] / "episodes" / file).exists()
    assert {path.name for path in (tmp_path / "geometric").iterdir()} == {
        "conditions", "records.parquet", "summary.json", "timing.json",
    }  # fmt: skip
    text = (tmp_path / "tables.md").read_text()
    assert "| block, shifted | geometric | - |" in text

    missing = "conditions/size_0.75-shift_0-noise_0.005/episodes/can_2-000000.parquet"
    (tmp_path / "geometric" / missing).unlink()
    reproduce(PLAN, ["geometric"], tmp_path, workers=1)
    assert "1 of 2 episodes to run" in capsys.readouterr().err
    assert read_records(tmp_path / "records.parquet").equals(records)
    timing = json.loads((tmp_path / "geometric" / "timing.json").read_text())
    assert [session["episodes"] for session in timing["sessions"]] == [2, 1]


def test_weights_that_do_not_ship_are_named_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("keypush.learning.card.weights_dir", lambda: tmp_path)
    assert main(["reproduce", "--scale", "quick", "--out", str(tmp_path / "r")]) == 2
    error = capsys.readouterr().err
    assert (
        "weights of keypoint, keypoint_no_com, behavior_cloning, surface, surface_no_com" in error
    )
    assert "--policies geometric geometric_no_com expert" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--policies", "centroid"], "--policies has 'centroid'"),
        (["--policies", "expert", "--workers", "0"], "--workers is 0"),
        (["--policies", "expert", "--ablation", "nowhere"], "nowhere"),
    ],
)
def test_mistakes_are_one_line(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["reproduce", "--scale", "quick", "--out", "r", *arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert (captured.err.count("\n"), captured.out) == (1, "")
