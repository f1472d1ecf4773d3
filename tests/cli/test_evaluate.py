"""`keypush evaluate`: conditions, seeds, records and pages of failures."""

import json
from pathlib import Path

import pytest

from keypush.cli.main import main
from keypush.evaluation.records import read_records
from keypush.learning.card import weights_path

SHORT = ("--set", "episode.max_steps=3", "noise.cloud_points=64")


def _evaluate(out: Path, *more: str) -> int:
    return main(["evaluate", "--policy", "centroid", "--objects", "plate", "--episodes", "1",
                 "--workers", "1", *SHORT, *more, "--out", str(out)])  # fmt: skip


def test_conditions_records_and_recorded_failures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grid = ("--sizes", "0.75", "1", "--com-shifts", "0.015", "--record-failures", "1")
    assert _evaluate(tmp_path, *grid) == 0
    printed = capsys.readouterr().out
    names = [f"size_{size}-shift_0.015-noise_0.005" for size in ("0.75", "1")]
    for name in names:
        assert f"centroid, scenario seed 1000000, {name}" in printed
        page = tmp_path / "recordings" / f"plate-0-{name}.html"
        assert "<title>keypush: A Franka Panda pushes the plate" in page.read_text()
        assert f"recorded: {page}" in printed
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert list(summary["conditions"]) == names
    records = read_records(tmp_path / "records.parquet")
    assert records["size_ratio"].to_pylist() == [0.75, 1.0]
    assert records["com_shift"].to_pylist() == [0.015, 0.015]


def test_the_saved_scenario_repeats_the_evaluation(tmp_path: Path) -> None:
    assert _evaluate(tmp_path / "first", "--seed", "3") == 0
    saved = str(tmp_path / "first" / "scenario.yaml")
    arguments = ["evaluate", "--scenario", saved, "--objects", "plate", "--episodes", "1"]
    assert main([*arguments, "--workers", "1", "--out", str(tmp_path / "again")]) == 0
    first, again = (tmp_path / name / "records.parquet" for name in ("first", "again"))
    assert read_records(first)["seed"].to_pylist() == [1_000_003]
    assert first.read_bytes() == again.read_bytes()


def test_weights_that_cannot_be_used_claim_no_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    weights = tmp_path / "mine.safetensors"
    for suffix in (".json", ".safetensors"):
        shipped = weights_path("surface_no_com").with_suffix(suffix)
        weights.with_suffix(suffix).write_bytes(shipped.read_bytes())
    whole = weights.read_bytes()
    out = tmp_path / "out"
    evaluate = ["evaluate", "--policy", "surface_no_com", "--weights", str(weights), "--objects",
                "plate", "--episodes", "1", "--workers", "1", "--out", str(out),
                "--set", "episode.max_steps=1"]  # fmt: skip
    weights.write_bytes(whole[: len(whole) // 2])
    assert main(evaluate) == 2
    assert "mine.safetensors: cannot be loaded" in capsys.readouterr().err
    weights.write_bytes(whole)
    assert main([*evaluate, "noise.cloud_points=20"]) == 2
    assert "noise.cloud_points is 20; allowed: at least 32" in capsys.readouterr().err
    assert not out.exists()
    assert main(evaluate) == 0
