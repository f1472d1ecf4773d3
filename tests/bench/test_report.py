"""The figures of the benchmark."""

import json

import numpy as np
import pytest

from keypush.bench.compare import ENGINES, Track, measure_objects
from keypush.bench.report import report_table, summarise_tracks
from keypush.cli.main import main
from keypush.scenario import EpisodeConfig, Scenario

PROMISED = {
    "rtf_median", "rtf_worst", "speedup_vs_discrete_1ms", "speedup_vs_mujoco_2ms",
    "final_position_rms_m", "outcome_agreement", "steps_ratio_vs_reference",
}  # fmt: skip


def _track(wall: float, outcomes: list[str], x: float, steps: int) -> Track:
    n = len(outcomes)
    return Track([10.0] * n, [wall] * n, [wall / 2] * n, outcomes, [steps] * n,
                 [np.array([x, 0.0, 0.0])] * n)  # fmt: skip


def test_figures_against_figures_by_hand() -> None:
    good, mixed = ["success", "success"], ["success", "toppled"]
    tracks = {
        "block": {
            "cenic": _track(0.1, mixed, 0.003, 66),
            "discrete": _track(10.0, good, 0.0, 60),
            "mujoco": _track(0.2, good, 0.01, 60),
        },
        "mug": {
            "cenic": _track(0.5, good, 0.001, 60),
            "discrete": _track(10.0, good, 0.0, 60),
            "mujoco": _track(0.2, good, 0.01, 60),
        },
    }
    report = summarise_tracks(Scenario(), tracks)
    assert report["rtf_median"] == pytest.approx((100 + 20) / 2)
    assert report["rtf_worst"] == pytest.approx(20)
    assert report["rtf_worst_cpu"] == pytest.approx(40)
    assert report["speedup_vs_discrete_1ms"] == pytest.approx((100 + 20) / 2)
    assert report["speedup_vs_mujoco_2ms"] == pytest.approx((2 + 0.4) / 2)
    assert report["outcome_agreement"] == 0.75
    assert report["final_position_rms_m"] == pytest.approx(np.sqrt((9 + 1 + 1) / 3) / 1000)
    assert report["steps_ratio_vs_reference"] == pytest.approx((66 + 60 + 60) / 180)
    assert report["mujoco"]["final_position_rms_m"] == pytest.approx(0.01)


def test_without_any_agreement_there_is_no_distance() -> None:
    engines = {name: _track(1.0, ["success"], 0.0, 60) for name in ENGINES}
    engines["cenic"] = _track(1.0, ["fell"], 0.0, 60)
    report = summarise_tracks(Scenario(), {"block": engines})
    assert report["outcome_agreement"] == 0
    assert report["final_position_rms_m"] is None
    assert "-" in [cell for column in report_table(report).columns for cell in column.cells]


def test_every_engine_runs_the_same_episodes() -> None:
    scenario = Scenario(policy="expert", episode=EpisodeConfig(max_steps=3))
    tracks = measure_objects(scenario, ["plate"], 2)["plate"]
    for track in tracks.values():
        assert track.outcomes == ["timed_out"] * 2
        assert track.steps == [3, 3]
        assert track.simulated == pytest.approx([0.3, 0.3])
        assert min(track.wall) > 0
        # The arm has not reached the object yet, which rests where it was put.
        np.testing.assert_allclose(track.positions, tracks["discrete"].positions, atol=2e-4)
    assert tracks["cenic"].positions[0][0] != tracks["cenic"].positions[1][0]


def test_json_is_one_object_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["bench", "sim", "--json", "--objects", "can,block", "--episodes", "1"]
    assert main([*arguments, "--set", "episode.max_steps=3"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report.keys() >= PROMISED
    assert report.keys() >= {"episodes", "simulation", "objects"}
    assert set(report["objects"]) == {"can", "block"}
    assert 0 < report["rtf_worst"] <= report["rtf_median"]
    assert report["outcome_agreement"] == 1.0
    assert 0 <= report["final_position_rms_m"] < 1e-3
    assert report["steps_ratio_vs_reference"] == 1.0


def test_the_table_has_every_object(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["bench", "sim", "--objects", "can", "--episodes", "1"]
    assert main([*arguments, "--set", "episode.max_steps=2"]) == 0
    out = capsys.readouterr().out
    assert "can" in out
    assert "CENIC" in out


@pytest.mark.parametrize("package", ["mujoco", "coacd"])
def test_without_a_package_the_error_says_so(
    package: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(__import__("sys").modules, package, None)
    assert main(["bench", "sim", "--episodes", "1"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert package in error
