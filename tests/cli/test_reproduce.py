"""`keypush reproduce`: a small plan from its start to its tables, stopped and gone on with."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
import pytest

from keypush.cli.main import main
from keypush.errors import UserError
from keypush.evaluation.records import read_records, write_records
from keypush.reproduction.plan import Plan
from keypush.reproduction.reproduce import reproduce

PLAN = Plan(objects=("can_2",), sizes=(0.75,), shifted=("block",), episodes=1)


SIZE, SHIFT = "size_0.75-shift_0-noise_0.005", "size_1-shift_0.015-noise_0.005"


def _run(out: Path) -> pa.Table:
    return reproduce(PLAN, ["geometric"], out, workers=1).records


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which all has run."""
    out = tmp_path_factory.mktemp("finished")
    _run(out)
    return out


def test_a_small_plan_from_its_start_to_its_tables(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    records = _run(tmp_path)
    assert "2 of 2 episodes to run for geometric: about 1 s" in capsys.readouterr().err
    assert {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()} == {
        "records.parquet", "speed.md", "summary.json", "tables.md",
        *(
            f"geometric/{condition}/{file}"
            for condition in (SIZE, SHIFT)
            for file in ("job.yaml", "records.parquet", "scenario.yaml", "timing.json")
        ),
    }  # fmt: skip
    assert records["folder"].to_pylist() == [f"geometric/{SIZE}", f"geometric/{SHIFT}"]
    assert read_records(tmp_path / "records.parquet").equals(records)
    assert "| block, shifted | geometric | - |" in (tmp_path / "tables.md").read_text()


def test_finished_parts_stay_and_others_are_run_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    records = _run(tmp_path)
    names = ("tables.md", "summary.json", "records.parquet")
    written = {name: (tmp_path / name).read_bytes() for name in names}
    part = tmp_path / "geometric" / SHIFT
    (part / "records.parquet").unlink()
    (tmp_path / "tables.md").unlink()
    kept = (tmp_path / "geometric" / SIZE / "records.parquet").stat().st_mtime_ns
    capsys.readouterr()
    assert _run(tmp_path).equals(records)
    assert "1 of 2 episodes to run" in capsys.readouterr().err
    assert (tmp_path / "geometric" / SIZE / "records.parquet").stat().st_mtime_ns == kept
    timing = json.loads((part / "timing.json").read_text())
    assert [session["episodes"] for session in timing["sessions"]] == [1, 1]
    assert {name: (tmp_path / name).read_bytes() for name in names} == written


def test_records_of_another_plan_are_refused(tmp_path: Path) -> None:
    _run(tmp_path)
    more = replace(PLAN, episodes=2)
    with pytest.raises(UserError, match=r"job\.yaml: episodes is 1 there and 2 now"):
        reproduce(more, ["geometric"], tmp_path, workers=1)
    path = tmp_path / "geometric" / SIZE / "records.parquet"
    write_records(read_records(path).slice(0, 0), path)
    with pytest.raises(UserError, match=r"records\.parquet: has 0 episodes; allowed: the 1"):
        _run(tmp_path)


@pytest.mark.parametrize(
    ("column", "value", "words"),
    [
        ("policy", "expert", "policy of row 0 is 'expert'; allowed: 'geometric', as in this plan"),
        ("object", "mug", "object of row 0 is 'mug'; allowed: 'can_2'"),
        ("episode", 7, "episode of row 0 is 7; allowed: 0"),
        ("seed", 3, "seed of row 0 is 3; allowed: 1000000"),
        ("size_ratio", 1.0, "size_ratio of row 0 is 1.0; allowed: 0.75"),
        ("com_shift", 0.01, "com_shift of row 0 is 0.01; allowed: 0.0"),
        ("cloud_deviation", 0.0, "cloud_deviation of row 0 is 0.0; allowed: 0.005"),
        ("push_speed", 0.2, "push_speed of row 0 is 0.2; allowed: 0.065"),
    ],
)
def test_records_of_another_evaluation_are_refused(
    column: str, value: object, words: str, finished: Path, tmp_path: Path
) -> None:
    shutil.copytree(finished, tmp_path / "r")
    path = tmp_path / "r" / "geometric" / SIZE / "records.parquet"
    (row,) = read_records(path).to_pylist()
    write_records([{**row, column: value}], path)
    with pytest.raises(UserError, match=f"{SIZE}/records.parquet: {words}") as caught:
        _run(tmp_path / "r")
    assert "\n" not in str(caught.value)


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
