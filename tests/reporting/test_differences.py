"""Runs that differ in what a report does not compare are told on one line."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from keypush.reporting.differences import find_differences
from keypush.reporting.episodes import gather_episodes
from keypush.reporting.page import render_page
from keypush.reporting.report import build_report
from keypush.reporting.runs import read_runs
from keypush.scenario import dump_scenario, parse_scenario
from tests.reporting.made_up import record, write_run


def _run(
    folder: Path, settings: str = "{}", job: dict[str, Any] | None = None, **fields: object
) -> Path:
    write_run(folder, [record(folder=".", **fields)])
    (folder / "scenario.yaml").write_text(dump_scenario(parse_scenario(settings)))
    (folder / "job.yaml").write_text(yaml.safe_dump(job or {"keypush": "0.1.0"}))
    return folder


def test_what_is_compared_is_no_difference(tmp_path: Path) -> None:
    first = _run(tmp_path / "first")
    second = _run(
        tmp_path / "second",
        "{policy: centroid, seed: 3, object: {name: can, size_ratio: 0.75}}",
        {"keypush": "0.1.0", "objects": ["can"], "weights_sha256": "ab"},
        policy="centroid",
    )
    assert find_differences(read_runs([first, second])) == ""


def test_versions_scenarios_and_files_are_named_on_one_line(tmp_path: Path) -> None:
    first = _run(tmp_path / "first", job={"keypush": "0.1.0", "policy_sha256": 64 * "a"})
    second = _run(
        tmp_path / "second",
        "{episode: {max_steps: 100}}",
        {"keypush": "0.2.0", "policy_sha256": 64 * "b"},
        episode=1,
    )
    table = read_runs([first, second])
    told = find_differences(table)
    assert told == (
        "these runs also differ in keypush (0.1.0, 0.2.0), file of surface_no_com (aaaaaaaa, "
        "bbbbbbbb), episode.max_steps (300, 100)"
    )
    assert told in render_page(build_report(gather_episodes(table), told), [])


def test_a_field_that_one_run_lacks_is_told(tmp_path: Path) -> None:
    first, second = _run(tmp_path / "first"), _run(tmp_path / "second", episode=1)
    older = second / "scenario.yaml"
    text = older.read_text()
    line = next(line for line in text.splitlines(keepends=True) if "touch_speed" in line)
    older.write_text(text.replace(line, ""))
    told = find_differences(read_runs([first, second]))
    assert told == "these runs also differ in planner.touch_speed (0.02, missing)"
    older.unlink()
    assert find_differences(read_runs([first, second])) == ""


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [
        ("jug crate", "crate jug", "in files of crate, jug (aaaaaaaa, bbbbbbbb)"),
        ("jug", "jug", "in files of jug (aaaaaaaa, bbbbbbbb)"),
        ("jug", "crate", ""),
        ("jug crate", "jug", ""),
    ],
)
def test_own_objects_are_compared_between_runs_that_pushed_the_same_ones(
    first: str, second: str, words: str, tmp_path: Path
) -> None:
    for digest, names in (("a", first), ("b", second)):
        run = _run(tmp_path / digest, job={"user_objects_sha256": 64 * digest})
        mine = [record(object=name, set="user", folder=".") for name in names.split()]
        write_run(run, [record(folder="."), *mine])
    table = read_runs([tmp_path / "a", tmp_path / "b"])
    assert find_differences(table) == (words and f"these runs also differ {words}")


def test_many_differences_are_counted(tmp_path: Path) -> None:
    first = _run(tmp_path / "first")
    many = "{table: {length: 1, width: 1, height: 1, friction: 1}, control: {max_rotation: 0.2, "
    many += "max_translation: 0.02}, planner: {tool_height: 0.02, free_speed: 0.1}}"
    second = _run(tmp_path / "second", many, episode=1)
    assert find_differences(read_runs([first, second])).endswith(" and 2 more")


def test_records_alone_say_nothing(tmp_path: Path) -> None:
    first = _run(tmp_path / "first")
    second = write_run(tmp_path / "second", [record(folder=".", episode=1)])
    for text in ("a: [", "keypush: 2000-13-01", 1000 * "[", "predictor"):
        for name in ("scenario.yaml", "job.yaml"):
            (second / name).write_text(text)
        assert find_differences(read_runs([first, second])) == ""


@pytest.mark.parametrize("text", ["predictor: null", "predictor: [1]", "planner: &p {a: {b: *p}}"])
def test_a_scenario_with_other_groups_is_only_different(text: str, tmp_path: Path) -> None:
    first = _run(tmp_path / "first", job={"weights_sha256": 64 * "a"})
    second = _run(tmp_path / "second", job={"weights_sha256": 64 * "b"}, episode=1)
    for run in (first, second):
        (run / "scenario.yaml").write_text(f"policy: surface\n{text}\n")
    told = find_differences(read_runs([first, second]))
    assert told == "these runs also differ in weights of surface (aaaaaaaa, bbbbbbbb)"
