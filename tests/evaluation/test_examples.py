"""Examples: the lots, episodes that repeat their records, the page and its Markdown."""

import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from keypush.errors import UserError
from keypush.evaluation.evaluate import evaluate
from keypush.evaluation.examples import MOMENTS, Choice, Example, choose_examples, record_example
from keypush.evaluation.examples_page import Gallery, render_markdown, render_page
from keypush.rollout.job import Job
from keypush.scenario import parse_scenario
from tests.reporting.made_up import record, write_run

SCRIPT = Path(__file__).parents[2] / "scripts" / "record_examples.py"


def _records(successes: dict[str, list[bool]], policy: str = "surface") -> pa.Table:
    return pa.Table.from_pylist(
        [
            {"policy": policy, "object": name, "folder": ".", "episode": i, "success": success}
            for name, found in successes.items()
            for i, success in enumerate(found)
        ]
    )


RECORDS = _records({"mug": [True] * 40 + [False] * 2, "plate": [True] * 40})


def _episodes(choices: list[Choice]) -> list[list[int]]:
    return [[record["episode"] for record in choice.records] for choice in choices]


def test_lots_are_the_same_every_time_and_for_every_choice_of_objects() -> None:
    both = choose_examples(RECORDS, ["mug", "plate"], policy=None, most=3, seed=0)
    plate = choose_examples(RECORDS, ["plate"], policy="surface", most=3, seed=0)
    assert _episodes(both)[2:] == _episodes(plate)
    mug = _episodes(both)[0]
    assert mug == sorted(set(mug))
    assert len(mug) == 3
    other = choose_examples(RECORDS, ["mug"], policy=None, most=3, seed=1)
    assert _episodes(other)[0] != mug
    # The order of the records decides nothing.
    turned = RECORDS.take(list(reversed(range(len(RECORDS)))))
    assert _episodes(choose_examples(turned, ["mug"], policy=None, most=3, seed=0))[0] == mug


def test_where_fewer_failed_all_of_them_are_shown() -> None:
    choices = choose_examples(RECORDS, ["mug", "plate"], policy=None, most=3, seed=0)
    assert [choice.found for choice in choices] == [40, 2, 40, 0]
    assert _episodes(choices)[1::2] == [[40, 41], []]
    assert [choice.episodes for choice in choices] == [42, 42, 40, 40]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--most", "0"], "--most is 0; allowed: 1 or more"),
        (["--most", "-1"], "--most is -1; allowed: 1 or more"),
        (["--seed", "-1"], "--seed is -1; allowed: 0 or more"),
        (["--objects", "teapot"], "--objects has teapot; allowed: can"),
        ([], "output folder OUT: cannot be written: File exists"),
    ],
)
def test_a_mistake_is_told_before_an_episode_runs(
    arguments: list[str], words: str, tmp_path: Path
) -> None:
    write_run(tmp_path / "run", [record(folder=".", object="can")])
    (tmp_path / "OUT").write_text("")
    command = [sys.executable, str(SCRIPT), "run", "OUT", "--objects", "can", *arguments]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(f"record_examples: {words}")  # no scenario was looked for
    assert done.stderr.count("\n") == 1


def test_each_episode_is_drawn_as_often() -> None:
    counts = np.zeros(10)
    records = _records({"mug": [True] * 10})
    for seed in range(400):
        (drawn, _) = _episodes(choose_examples(records, ["mug"], policy=None, most=3, seed=seed))
        counts[drawn] += 1
    assert counts.sum() == 1200
    assert np.abs(counts - 120).max() < 45  # five standard deviations


def test_mistakes_are_named() -> None:
    several = pa.concat_tables([RECORDS, _records({"mug": [True]}, "expert")])
    with pytest.raises(UserError, match=r"--policy is missing; allowed: one of expert, surface"):
        choose_examples(several, ["mug"], policy=None, most=3, seed=0)
    with pytest.raises(UserError, match=r"--policy is bc; allowed: surface"):
        choose_examples(RECORDS, ["mug"], policy="bc", most=3, seed=0)
    with pytest.raises(UserError, match=r"--objects has jug; allowed: mug, plate"):
        choose_examples(RECORDS, ["jug"], policy=None, most=3, seed=0)
    with pytest.raises(UserError, match=r"--objects has mug twice; allowed: each once"):
        choose_examples(RECORDS, ["mug", "plate", "mug"], policy=None, most=3, seed=0)


def test_an_example_repeats_its_record_and_says_so_where_it_does_not(tmp_path: Path) -> None:
    scenario = parse_scenario(
        "{policy: expert, seed: 1000000, episode: {max_steps: 12}, object: {size_ratio: 0.75}}"
    )
    records = evaluate(
        [Job(scenario=scenario, objects=("plate",), episodes=2)], tmp_path, workers=1
    )
    (_, failures) = choose_examples(records, ["plate"], policy=None, most=1, seed=0)
    (record,) = failures.records
    example = record_example(tmp_path, record, tmp_path / "out")
    assert example.differences == ()
    assert example.condition == "size 0.75"
    assert example.end.startswith("timed out after 12 steps, ")
    assert example.course == "Never touched"
    assert len(example.moments) == len(MOMENTS)
    assert example.moments[0] == 0.0
    assert example.moments[-1] == pytest.approx(1.2)
    assert example.page.name == f"plate-{record['episode']}-size_0.75-shift_0-noise_0.005.html"
    assert example.page.stat().st_size > 1_000_000
    wrong = {**record, "steps": 11, "final_x": 9.0}
    again = record_example(tmp_path, wrong, tmp_path / "out").differences
    assert again[0] == "steps was 11, is 12"
    assert again[1].startswith("final_x was 9, is ")
    assert len(again) == 2


def _example(success: bool, **changes: Any) -> Example:
    example = Example(
        record={"object": "bumpy_toy", "episode": 7, "success": success},
        condition="",
        end="success after 74 steps" if success else "fell after 80 steps",
        course="Pushed < 31 cm | turned",
        differences=(),
        page=Path("somewhere/bumpy_toy-7.html"),
        moments=(0.0, 1.0, 2.0, 3.0),
    )
    return replace(example, **changes)


def _gallery(**changes: Any) -> Gallery:
    good, bad = _example(success=True), _example(success=False, condition="size 0.75")
    none = Choice("candle", success=False, found=0, episodes=50, records=())
    choices = [Choice("bumpy_toy", success, 9, 50, ({},)) for success in (True, False)]
    groups = [(choices[0], [good]), (choices[1], [bad]), (none, [])]
    return replace(Gallery(title="Examples of <surface>", lead="By lot.", groups=groups), **changes)


class _Tags(HTMLParser):
    """Notes elements and their attributes."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    def values(self, tag: str, name: str) -> list[str | None]:
        return [attributes.get(name) for found, attributes in self.found if found == tag]


def test_the_page_links_beside_itself_and_needs_no_script() -> None:
    pictures = [b"\xff\xd8"] * len(MOMENTS)
    html = render_page(_gallery(stills={Path("somewhere/bumpy_toy-7.html"): pictures}))
    tags = _Tags(html)
    assert tags.values("a", "href") == ["bumpy_toy-7.html"] * 2
    assert tags.values("script", "src") == []
    assert tags.values("img", "alt") == [*MOMENTS] * 2
    assert all(str(source).startswith("data:image/jpeg") for source in tags.values("img", "src"))
    assert "Examples of &lt;surface&gt;" in html
    assert "Pushed &lt; 31 cm" in html
    assert "1 of 9 successes in 50 episodes; 1 of 9 failures in 50 episodes" in html
    assert "no failures in 50 episodes" in html
    assert "All 2 episodes ran as in their records." in html


def test_markdown_has_the_same_rows() -> None:
    lines = render_markdown(_gallery()).splitlines()
    table = [line for line in lines if line.startswith("| bumpy_toy")]
    went, link = "Pushed < 31 cm \\| turned", "[bumpy_toy-7](bumpy_toy-7.html)"
    assert [line.replace("\N{NO-BREAK SPACE}", " ") for line in table] == [
        f"| bumpy_toy | episode 7 | success after 74 steps | {went} | {link} |",
        f"| bumpy_toy | episode 7, size 0.75 | fell after 80 steps | {went} | {link} |",
    ]
    assert "- candle: no failures in 50 episodes" in lines


def test_an_episode_that_did_not_repeat_stands_out() -> None:
    odd = _example(success=True, differences=("steps was 11, is 12",))
    groups = [(Choice("bumpy_toy", True, 9, 50, ({},)), [odd])]
    gallery = _gallery(groups=groups)
    assert '<span class="warning">steps was 11, is 12</span>' in render_page(gallery)
    assert "**steps was 11, is 12**" in render_markdown(gallery)
    assert "1 of 1 episodes did not run as in their records" in render_markdown(gallery)
