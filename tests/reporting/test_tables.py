"""Tables against counts made by hand and by the plainest loops."""

from collections import defaultdict
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from keypush.evaluation.recorded_condition import Family
from keypush.evaluation.wilson import wilson_interval
from keypush.reporting.comparison import compare_drivers
from keypush.reporting.detail_tables import effort_table, failure_table, reason_table
from keypush.reporting.episodes import FAILURES
from keypush.reporting.paired import holm, mcnemar_p
from keypush.reporting.rate_tables import (
    comparison_table,
    condition_table,
    object_table,
    set_table,
    shift_table,
    size_table,
)
from keypush.reporting.report import build_report
from keypush.reporting.words import grouped, p_value, percent, points
from tests.reporting.made_up import failed, gathered, many_records, record


def test_rates_by_set(tmp_path: Path) -> None:
    records = [
        *(record(episode=i) for i in range(7)),
        *(failed(episode=i) for i in range(7, 10)),
        record(object="can_2", set="id", settled_success=False),
        failed(object="plate", set="ood"),
    ]
    low, high = (f"{100 * end:.1f}" for end in wilson_interval(7, 10))
    assert set_table(gathered(tmp_path, records)).rows == [
        ("expert", "training objects", "10", "70.0 %", f"{low} to {high} %", "70.0 %"),
        ("expert", "unseen (similar)", "1", "100.0 %", "20.7 to 100.0 %", "0.0 %"),
        ("expert", "unseen (different)", "1", "0.0 %", "0.0 to 79.3 %", "0.0 %"),
        ("expert", "unseen (both)", "2", "50.0 %", "9.5 to 90.5 %", "0.0 %"),
    ]


def test_every_episode_is_in_one_row_of_each_table(tmp_path: Path) -> None:
    records = many_records(episodes=3)
    episodes = gathered(tmp_path, records)
    parts = {
        size_table: episodes.of(Family.NOMINAL, Family.SIZE),
        shift_table: episodes.of(Family.SHIFT),
        condition_table: episodes,
        failure_table: episodes,
    }
    for make, part in parts.items():
        table = make(part)
        column = table.headings.index("N")
        assert len(part) > 0
        assert sum(int(row[column]) for row in table.rows) == len(part), table.caption
        assert {len(row) for row in table.rows} == {len(table.headings)}


def test_rates_by_size_are_those_of_a_plain_loop(tmp_path: Path) -> None:
    records = [r for r in many_records(episodes=3) if not r["com_shift"]]
    won = defaultdict(list)
    for r in records:
        won[r["policy"], r["set"], r["size_ratio"]].append(r["success"])
    table = size_table(gathered(tmp_path, records))
    assert sorted((row[0], row[2], row[4]) for row in table.rows) == sorted(
        (policy, f"{size:g}", percent(float(np.mean(found))))
        for (policy, _, size), found in won.items()
    )


def test_shares_of_capped_shifts(tmp_path: Path) -> None:
    records = [record(episode=i, com_shift=0.015, com_capped=i == 0) for i in range(4)]
    (row,) = shift_table(gathered(tmp_path, records)).rows
    assert row[1] == "COM shifted 15 mm"
    assert row[-1] == "25.0 %"


def test_objects_that_a_policy_did_not_push_are_left_open(tmp_path: Path) -> None:
    records = [record(), record(policy="centroid"), failed(object="can")]
    table = object_table(gathered(tmp_path, records))
    assert table.headings == ["objects", "object", "expert", "centroid"]
    assert table.rows == [
        ("training objects", "mug", "1/1 (20.7 to 100.0 %)", "1/1 (20.7 to 100.0 %)"),
        ("training objects", "can", "0/1 (0.0 to 79.3 %)", "\N{EN DASH}"),
    ]


def test_objects_with_a_shifted_centre_of_mass_have_a_table_of_their_own(tmp_path: Path) -> None:
    shifted = [failed(com_shift=0.01), record(com_shift=0.02)]
    sections = build_report(gathered(tmp_path, [record(), *shifted])).sections
    tables = {table.caption: table.rows for section in sections for table in section.tables}
    assert tables["Success by object"][0][2] == "1/1 (20.7 to 100.0 %)"
    assert tables["Success by object, COM shifted 10 mm"][0][2] == "0/1 (0.0 to 79.3 %)"
    assert tables["Success by object, COM shifted 20 mm"][0][2] == "1/1 (20.7 to 100.0 %)"


def test_failures_by_class(tmp_path: Path) -> None:
    records = [record(), *(failed(episode=i, outcome=o) for i, o in enumerate(FAILURES, 1))]
    (row,) = failure_table(gathered(tmp_path, records)).rows
    assert row == ("expert", "nominal", "5", "4 (80.0 %)", *(["1 (20.0 %)"] * 4))


def test_a_policys_own_failure_has_a_column_and_its_reasons_only_where_it_occurs(
    tmp_path: Path,
) -> None:
    usual = gathered(tmp_path / "usual", [record(), failed(episode=1)])
    assert "policy failed" not in failure_table(usual).headings
    assert reason_table(usual).rows == []
    broken = {"outcome": "policy_failed", "policy": "mine.py:Ray"}
    reasons = ["no answer within 10 s", "keypoint is not finite", "no answer within 10 s"]
    records = [failed(**broken, episode=i, reason=reason) for i, reason in enumerate(reasons)]
    episodes = gathered(tmp_path / "broken", [record(), *records])
    assert failure_table(episodes).rows[1][-1] == "3 (100.0 %)"
    assert reason_table(episodes).rows == [
        ("mine.py:Ray", "keypoint is not finite", "1"),
        ("mine.py:Ray", "no answer within 10 s", "2"),
    ]


def test_efforts_are_medians_of_successes_and_errors_of_all(tmp_path: Path) -> None:
    efforts = [(60, 0.1, 0.4, 0.001), (80, 0.2, 0.5, 0.002), (100, 0.6, 0.9, 0.003)]
    records = [
        record(episode=i, steps=s, object_path=o, tool_path=t, keypoint_error=k)
        for i, (s, o, t, k) in enumerate(efforts)
    ]
    records.append(failed(episode=3, steps=300, object_path=2.0, keypoint_error=0.004))
    records.append(failed(policy="behavior_cloning", keypoint_error=float("nan")))
    rows = effort_table(gathered(tmp_path, records)).rows
    assert rows[0][2:] == ("3", "80", "20.0 cm", "50.0 cm", "2.5 mm", "3.7 mm")
    assert rows[1][2:] == ("0", *(["\N{EN DASH}"] * 5))


def test_comparisons_pair_the_same_episodes(tmp_path: Path) -> None:
    records = many_records(episodes=4)
    del records[::5]  # so that no policy has every episode
    found = compare_drivers(gathered(tmp_path, records))
    nominal = {"unseen": {}, "train": {}}  # type: ignore[var-annotated]
    for r in records:
        if r["size_ratio"] == 1 and not r["com_shift"]:
            group = "train" if r["set"] == "train" else "unseen"
            key = (r["object"], r["episode"])
            nominal[group].setdefault(r["policy"], {})[key] = r["success"]
    expected = [
        (a, b, len(both), sum(x[k] and not y[k] for k in both), sum(y[k] > x[k] for k in both))
        for by_policy in nominal.values()
        for (a, x), (b, y) in combinations(by_policy.items(), 2)
        for both in [x.keys() & y.keys()]
    ]
    assert [
        (*c.drivers, c.pairs, c.only_first, c.only_second)
        for c in found
        if c.family is Family.NOMINAL
    ] == expected
    plain = [mcnemar_p(c.only_first, c.only_second) for c in found]
    assert [c.p_value for c in found] == pytest.approx(holm(plain))
    assert {c.family for c in found} == {Family.NOMINAL, Family.SIZE, Family.SHIFT}


def test_policies_without_a_common_episode_are_not_compared(tmp_path: Path) -> None:
    records = [record(), record(policy="centroid", seed=1), failed(policy="surface", episode=1)]
    assert compare_drivers(gathered(tmp_path, records)) == []


def test_a_comparison_as_a_row(tmp_path: Path) -> None:
    records = [record(episode=i) for i in range(8)]
    records += [failed(policy="centroid", episode=i) for i in range(8)]
    table = comparison_table(compare_drivers(gathered(tmp_path, records)))
    (row,) = table.rows
    assert row == (
        "training objects, nominal", "expert \N{MINUS SIGN} centroid", "8", "8", "0", "+100.0",
        "+35.1 to +100.0", "0.008",
    )  # fmt: skip


def test_figures_are_written_in_one_way() -> None:
    assert [points(x) for x in (0.1234, -0.05, 0.0, -0.0004)] == [
        "+12.3", "\N{MINUS SIGN}5.0", "0.0", "0.0",
    ]  # fmt: skip
    assert [p_value(p) for p in (0.0004, 0.0314, 1.0)] == ["< 0.001", "0.031", "1.000"]
    assert grouped(12345) == "12\N{NO-BREAK SPACE}345"
