"""The benchmark of networks: every learned policy, figures, and how true they are."""

import json

import pytest

from keypush.bench.predictor import summarise_predictors
from keypush.cli.main import main
from keypush.policies import POLICIES
from keypush.scenario import Scenario

ARGUMENTS = ["bench", "predictor", "--objects", "can,mug", "--episodes", "1"]
FIGURES = {
    "latency_ms_p50", "latency_ms_p90", "torch_latency_ms_p50", "torch_latency_ms_p90",
    "latency_cpu_ms_p50", "torch_latency_cpu_ms_p50", "speedup_vs_torch", "max_abs_error_m",
}  # fmt: skip


def test_every_learned_policy_is_measured_and_true(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ARGUMENTS, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["scenes"] == 4
    networks = {line["policy"]: line for line in report["networks"]}
    learned = {name for name, policy in POLICIES.items() if policy.weights_kind}
    assert networks.keys() == learned | {None}
    assert (report["policy"], report["patch_size"]) == ("keypoint", 32)
    sizes = {(line["patch_size"], line["layers"]) for line in report["networks"]}
    assert sizes == {(32, 2), (16, 2), (32, 3), (16, 3)}
    for line in [report, *report["networks"]]:
        assert line.keys() >= FIGURES
        assert line["weights"] in ("shipped", "random")
        assert 0 < line["latency_ms_p50"] <= line["latency_ms_p90"]
        assert 0 <= line["max_abs_error_m"] <= 1e-4
    assert networks["surface_no_com"]["weights"] == "shipped"
    assert networks["behavior_cloning"]["max_abs_error_rad"] <= 1e-4


def test_a_table_has_a_line_for_every_network(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(ARGUMENTS) == 0
    out = capsys.readouterr().out
    assert "4 scenes of 512 points" in " ".join(out.split())
    assert out.count("random") + out.count("shipped") == 8


def test_the_report_leads_with_the_thesis_network() -> None:
    lines = [
        {"policy": name, "latency_ms_p50": i} for i, name in enumerate(("surface", "keypoint"))
    ]
    report = summarise_predictors(Scenario(), lines, 7)
    assert (report["latency_ms_p50"], report["scenes"], len(report["networks"])) == (1, 7, 2)
