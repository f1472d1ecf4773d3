"""The verbs on short episodes."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from keypush.cli.main import main
from keypush.scenario import load_scenario

SHORT = ("--set", "episode.max_steps=3", "noise.cloud_points=64")


def test_evaluate_writes_summary_scenario_and_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [
        "evaluate", "--policy", "centroid", "--objects", "plate,can", "--episodes", "2",
        "--workers", "1", "--seed", "7", *SHORT, "--out", str(tmp_path / "e"),
    ]  # fmt: skip
    assert main(arguments) == 0
    assert "plate" in capsys.readouterr().out
    summary = json.loads((tmp_path / "e" / "summary.json").read_text())
    assert set(summary["objects"]) == {"plate", "can"}
    assert summary["objects"]["can"]["episodes"] == 2
    assert summary["objects"]["can"]["failures"] == {"timed_out": 2}
    assert (summary["policy"], summary["seed"]) == ("centroid", 1_000_007)
    scenario = load_scenario(tmp_path / "e" / "scenario.yaml")
    assert (scenario.episode.max_steps, scenario.noise.cloud_points) == (3, 64)


def test_flags_outrank_the_file_and_the_file_outranks_defaults(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(
        "{seed: 1, policy: expert, object: {name: can, mass: 0.2}, episode: {max_steps: 3}}"
    )
    arguments = [
        "collect", "--scenario", str(tmp_path / "mine.yaml"), "--set", "object.mass=0.3",
        "--seed", "5", "--objects", "can", "--episodes-per-object", "1", "--workers", "1",
        "--out", str(tmp_path / "c"),
    ]  # fmt: skip
    assert main(arguments) == 0
    scenario = load_scenario(tmp_path / "c" / "meta" / "scenario.yaml")
    assert (scenario.seed, scenario.object.mass, scenario.episode.max_steps) == (5, 0.3, 3)


def test_diagram_draws_every_system_and_wire(tmp_path: Path) -> None:
    assert main(["diagram", "--policy", "expert", "--out", str(tmp_path / "new" / "d.svg")]) == 0
    root = ET.parse(tmp_path / "new" / "d.svg").getroot()
    texts = {"".join(element.itertext()) for element in root.iter() if element.tag.endswith("text")}
    assert {"station", "plant", "ExpertPlanner", "PointCloudSensor", "tool_action"} <= texts
