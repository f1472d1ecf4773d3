"""`keypush demo` as a user runs it."""

import json
import subprocess
from pathlib import Path

import pytest

from keypush.cli.main import main
from keypush.scenario import load_scenario
from tests.cli.command import KEYPUSH

SHORT = ["--policy", "expert", "--object", "toy_car", "--seed", "2", "--set", "episode.max_steps=3"]


def test_two_at_once_tell_and_write_everything(tmp_path: Path) -> None:
    outs = [tmp_path / "a", tmp_path / "b"]
    demos = [
        subprocess.Popen(
            [KEYPUSH, "demo", *SHORT, "--out", out],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for out in outs
    ]
    for out, demo in zip(outs, demos, strict=True):
        told, complaints = demo.communicate(timeout=100)
        assert (demo.returncode, complaints) == (0, "")
        title, policy, outcome, page = told.splitlines()
        assert title == "A Franka Panda pushes the toy car."
        assert "expert" in policy
        assert "time ran out after 3 policy steps" in outcome
        assert str(out / "recording.html") in page
        _check_files(out)


def _check_files(out: Path) -> None:
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["object"], summary["outcome"], summary["steps"]) == ("toy_car", "timed_out", 3)
    assert summary["final_distance"] > 0.05
    assert load_scenario(out / "scenario.yaml").seed == 2
    assert (out / "recording.html").stat().st_size <= 12_000_000


def test_a_file_that_cannot_be_written_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "scenario.yaml").mkdir()
    assert main(["demo", *SHORT, "--out", str(tmp_path)]) == 2
    path = tmp_path / "scenario.yaml"
    expected = f"keypush: output file {path}: is a folder; allowed: a file\n"
    assert capsys.readouterr().err == expected
