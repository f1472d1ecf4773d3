"""The summary of episodes, and its table."""

import io
import json

import pytest
from rich.console import Console

from keypush.evaluation.summary import summarise
from keypush.evaluation.table import summary_table
from keypush.evaluation.wilson import wilson_interval


def _episodes() -> list[dict[str, object]]:
    outcomes = {
        "mug": ["success", "success", "toppled", "fell"],
        "bottle": ["success", "timed_out", "toppled", "toppled"],
    }
    return [
        {"object": name, "outcome": o, "success": o == "success", "settled_success": o == "success"}
        for name, mine in outcomes.items()
        for o in mine
    ]


def _table_lines(episodes: list[dict[str, object]]) -> list[str]:
    text = io.StringIO()
    Console(file=text, width=100).print(summary_table(summarise(episodes), "expert"))
    return text.getvalue().splitlines()


def test_rates_intervals_and_failures() -> None:
    episodes = _episodes()
    episodes[0]["settled_success"] = False
    summary = summarise(episodes)
    assert summary["success_rate"] == 3 / 8
    assert summary["settled_success_rate"] == 2 / 8
    assert summary["failures"] == {"fell": 1, "timed_out": 1, "toppled": 3}
    assert summary["objects"]["mug"] == {
        "episodes": 4,
        "successes": 2,
        "success_rate": 0.5,
        "wilson95": list(wilson_interval(2, 4)),
        "settled_success_rate": 0.25,
        "settled_wilson95": list(wilson_interval(1, 4)),
        "failures": {"fell": 1, "toppled": 1},
    }
    assert list(summary["objects"]) == ["mug", "bottle"]
    json.dumps(summary)


def test_counts_add_up() -> None:
    summary = summarise(_episodes())
    for line in [summary, *summary["objects"].values()]:
        assert line["episodes"] == line["successes"] + sum(line["failures"].values())


def test_the_share_of_capped_shifts_is_told_where_there_are_any() -> None:
    episodes = [{**e, "com_capped": i in (0, 1, 2)} for i, e in enumerate(_episodes())]
    summary = summarise(episodes)
    assert summary["objects"]["mug"]["com_capped"] == 3 / 4
    assert "com_capped" not in summary["objects"]["bottle"]
    assert summary["com_capped"] == 3 / 8
    lines = _table_lines(episodes)
    assert any("COM capped" in line for line in lines)
    mug, bottle = (next(line for line in lines if name in line) for name in ("mug", "bottle"))
    assert "75.0%" in mug
    assert " 0.0% " in bottle


def test_without_capped_shifts_nothing_is_said_of_them() -> None:
    episodes = [{**e, "com_capped": False} for e in _episodes()]
    assert summarise(episodes) == summarise(_episodes())
    assert "COM" not in "".join(_table_lines(episodes))


def test_steps_and_lengths_are_told_where_they_are_known() -> None:
    episodes = _episodes()
    for number, episode in enumerate(episodes):
        error = float("nan") if number == 0 else 0.01 * number
        episode |= {"steps": 10 * number, "object_path": 0.1, "tool_path": 0.5 * number,
                    "keypoint_error": error}  # fmt: skip
    summary = summarise(episodes)
    # Successes are the episodes 0, 1 (mug) and 4 (bottle).
    assert summary["median_steps"] == 10
    assert summary["objects"]["mug"]["median_steps"] == 5
    assert summary["mean_object_path"] == pytest.approx(0.1)
    assert summary["mean_tool_path"] == pytest.approx(0.5 * 28 / 8)
    assert summary["mean_keypoint_error"] == pytest.approx(0.01 * 28 / 7)
    assert summary["objects"]["mug"]["mean_keypoint_error"] == pytest.approx(0.02)
    lost = [e | {"success": False, "keypoint_error": float("nan")} for e in episodes]
    assert summarise(lost)["median_steps"] is None
    assert summarise(lost)["mean_keypoint_error"] is None


def test_no_episodes_are_refused() -> None:
    with pytest.raises(ValueError, match="no episodes"):
        summarise([])


def test_table_shows_every_object_and_the_total() -> None:
    lines = _table_lines(_episodes())
    mug, total = (next(line for line in lines if name in line) for name in ("mug", "all"))
    assert "50.0%" in mug
    assert "fell 1, toppled 1" in mug
    assert "37.5%" in total
    assert "13.7% to 69.4%" in total
