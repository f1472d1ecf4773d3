"""What lies in the folders, gathered: who drove, what was varied, what counts once."""

import math
import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from keypush.errors import UserError
from keypush.evaluation.recorded_condition import Condition, Family, make_condition
from keypush.evaluation.records import RECORDS_FILE
from keypush.reporting.comparison import compare_drivers
from keypush.reporting.detail_tables import failure_table
from keypush.reporting.episodes import gather_episodes
from keypush.reporting.rate_tables import size_table
from keypush.reporting.runs import find_recordings, read_runs
from tests.reporting.made_up import failed, gathered, many_records, record, write_run


def test_an_episode_that_lies_in_two_folders_counts_once(tmp_path: Path) -> None:
    records = many_records(episodes=2)
    whole = write_run(tmp_path / "reproduced", records)
    part = write_run(whole / "expert", [r for r in records if r["policy"] == "expert"])
    twice = gather_episodes(read_runs([whole, part, whole]))
    assert len(twice) == len(records)
    assert twice["success"].sum() == sum(r["success"] for r in records)


@pytest.mark.parametrize(
    ("first", "second", "field", "values"),
    [
        (record(), failed(), "success", "is False here and True"),
        (record(), record(steps=81), "steps", "is 81 here and 80"),
        (record(keypoint_error=math.nan), record(), "keypoint_error", "is 0.004 here and nan"),
    ],
)
def test_the_same_episode_with_two_results_is_refused(
    first: dict[str, object], second: dict[str, object], field: str, values: str, tmp_path: Path
) -> None:
    runs = [write_run(tmp_path / name, [r]) for name, r in (("a", first), ("b", second))]
    with pytest.raises(UserError, match=f"b: {field} of episode 0, seed 0") as caught:
        gather_episodes(read_runs(runs))
    assert values in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "other",
    [
        {"policy": "centroid"}, {"weights": "mine.safetensors"}, {"object": "can"}, {"seed": 1},
        {"size_ratio": 0.75}, {"com_shift": 0.015}, {"cloud_deviation": 0.01}, {"episode": 1},
        {"push_speed": 0.2},
    ],
    ids=lambda other: next(iter(other)),
)  # fmt: skip
def test_what_makes_another_episode(other: dict[str, object], tmp_path: Path) -> None:
    assert len(gathered(tmp_path, [record(), failed(**other)])) == 2


def test_drivers_are_told_apart_by_weights_only_where_they_must_be(tmp_path: Path) -> None:
    weights = [("expert", ""), ("surface", "a.safetensors"), ("surface", "b.safetensors")]
    episodes = gathered(tmp_path, [record(policy=p, weights=w) for p, w in weights])
    assert episodes.values("driver") == ["expert", "surface (a)", "surface (b)"]


@pytest.mark.parametrize(
    ("numbers", "words", "family"),
    [
        ((1.0, 0.0, 0.005, 0.065), "nominal", Family.NOMINAL),
        ((1.0, math.nan, math.nan, math.nan), "nominal", Family.NOMINAL),
        ((0.75, 0.0, 0.005, 0.065), "size 0.75", Family.SIZE),
        ((1.0, 0.015, 0.005, 0.065), "COM shifted 15 mm", Family.SHIFT),
        ((1.0, 0.0, 0.01, 0.065), "cloud noise 10 mm", Family.OTHER),
        ((1.25, 0.015, 0.005, 0.2), "size 1.25, COM shifted 15 mm, push speed 20 cm/s",
         Family.OTHER),
    ],
)  # fmt: skip
def test_conditions_have_words_and_a_family(
    numbers: tuple[float, float, float, float], words: str, family: Family
) -> None:
    condition = make_condition(*numbers)
    assert (condition.words, condition.family) == (words, family)
    assert isinstance(condition, Condition)


@pytest.mark.parametrize("number", range(1, 300, 7))
def test_words_of_ordinary_numbers_have_no_more_digits_than_they_need(number: int) -> None:
    size, shift, noise, speed = 1 + number / 1e3, number / 1e4, 0.005 + number / 1e5, number / 1e3
    assert make_condition(size, shift, noise, speed).words == (
        f"size {size:g}, COM shifted {1000 * shift:g} mm, cloud noise {1000 * noise:g} mm"
        + ("" if speed == 0.065 else f", push speed {100 * speed:g} cm/s")
    )


def test_conditions_that_hardly_differ_have_rows_of_their_own(tmp_path: Path) -> None:
    sizes = [1.0, 1.0000001, 1.0000002]
    varied: list[dict[str, object]] = [{"size_ratio": size} for size in sizes]
    varied += [{"com_shift": 0.015}, {"com_shift": 0.015000001}]
    episodes = gathered(tmp_path, [record(**values) for values in varied])
    assert episodes.values("condition") == [
        "nominal", "size 1.0000001", "size 1.0000002", "COM shifted 15 mm",
        "COM shifted 15.000001 mm",
    ]  # fmt: skip
    assert [row[2] for row in failure_table(episodes).rows] == ["1"] * 5
    sized = episodes.of(Family.NOMINAL, Family.SIZE)
    assert [row[2] for row in size_table(sized).rows] == ["1", "1.0000001", "1.0000002"]


def test_sizes_that_differ_within_a_folder_are_one_condition(tmp_path: Path) -> None:
    sizes = [0.83, 1.0, 1.17]
    records = [
        record(policy=policy, size_ratio=size, episode=i, folder=policy)
        for policy in ("expert", "centroid")
        for i, size in enumerate(sizes)
    ]
    records.append(record(episode=9))
    episodes = gathered(tmp_path, records)
    assert episodes.values("condition") == ["nominal", "varied size"]
    assert len(episodes.of(Family.OTHER)) == 6
    assert [c.pairs for c in compare_drivers(episodes)] == [3]


def test_conditions_are_ordered_by_family_and_size(tmp_path: Path) -> None:
    varied = [{"com_shift": 0.015}, {"size_ratio": 1.25}, {"cloud_deviation": 0.0}, {},
              {"size_ratio": 0.75}]  # fmt: skip
    episodes = gathered(tmp_path, [record(**values) for values in varied])
    assert episodes.values("condition") == [
        "nominal", "size 0.75", "size 1.25", "COM shifted 15 mm", "cloud noise 0 mm",
    ]  # fmt: skip


def test_a_split_loses_nothing(tmp_path: Path) -> None:
    episodes = gathered(tmp_path, many_records(episodes=2))
    for name in episodes.order:
        parts = list(episodes.split(name))
        assert sum(len(part) for _, part in parts) == len(episodes)
        assert all(set(part[name]) == {value} for value, part in parts)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"outcome": "vanished"}, "outcome is 'vanished'; allowed: success, toppled"),
        ({"set": "test"}, "set is 'test'; allowed: train"),
    ],
)
def test_unknown_names_are_refused(values: dict[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=words):
        gathered(tmp_path, [record(**values)])


def test_folders_without_records_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"holds no records\.parquet; allowed: a folder"):
        read_runs([tmp_path])
    with pytest.raises(UserError, match="no episode was recorded"):
        read_runs([write_run(tmp_path / "empty", [])])


def test_damaged_records_are_refused(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", many_records(episodes=2))
    content = bytearray((run / RECORDS_FILE).read_bytes())
    content[len(content) // 3] ^= 0xFF
    (run / RECORDS_FILE).write_bytes(content)
    with pytest.raises(UserError, match="cannot be read"):
        read_runs([run])


def test_records_without_a_column_are_refused(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", [record()])
    table = pq.read_table(run / RECORDS_FILE).drop_columns(["goal_x"])
    pq.write_table(table, run / RECORDS_FILE)
    with pytest.raises(UserError, match="lacks the column goal_x"):
        read_runs([run])


def test_recordings_are_found_beside_and_within_runs(tmp_path: Path) -> None:
    names = ["a/recordings/mug-3.html", "a/expert/conditions/size_1/recordings/tall can.html"]
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text("")
    (tmp_path / "a" / "recordings" / "notes.txt").write_text("")
    page = tmp_path / "pages" / "report.html"
    found = find_recordings([tmp_path / "a", tmp_path / "a" / "expert"], page)
    inner = "../a/expert/conditions/size_1"
    assert found == [
        ("tall can", inner, f"{inner}/recordings/tall%20can.html"),
        ("mug-3", "../a", "../a/recordings/mug-3.html"),
    ]
    shutil.rmtree(tmp_path / "a")
    assert find_recordings([tmp_path / "a"], page) == []
