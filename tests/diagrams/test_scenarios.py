"""The scenario files that ship: each loads, builds its diagram and runs."""

from pathlib import Path

import pytest

import diagrams
from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import load_scenario

FILES = sorted((Path(diagrams.__file__).parent / "scenarios").glob("*.yaml"))


def test_scenarios_ship_with_the_package() -> None:
    assert [file.stem for file in FILES] == [
        "demo",
        "expert_with_resets",
        "reference_1ms",
        "varied",
    ]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_scenario_file_runs(file: Path) -> None:
    scenario = load_scenario(file)
    scenario.episode.max_steps = 3
    result = EpisodeRunner(scenario).run(0)
    assert result.summary["outcome"] == "timed_out"
    assert result.rows["time"][-1] == pytest.approx(0.3)
