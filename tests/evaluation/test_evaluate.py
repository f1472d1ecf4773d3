"""Evaluations of one condition and of several: layout, records, report, resuming."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from keypush.errors import UserError
from keypush.evaluation.conditions import grid
from keypush.evaluation.evaluate import evaluate, evaluation_report
from keypush.evaluation.records import read_records
from keypush.evaluation.table import conditions_table
from keypush.rollout.job import Job
from keypush.scenario import parse_scenario
from tests.rollout.short_scenarios import bytes_of

SCENARIO = parse_scenario("{policy: geometric, seed: 1000000, episode: {max_steps: 4}}")
SMALL, NORMAL = (f"conditions/size_{size}-shift_0-noise_0.005" for size in ("0.75", "1"))


def _jobs(*sizes: float) -> list[Job]:
    job = Job(scenario=SCENARIO, objects=("plate", "can_2"), episodes=2)
    return [replace(job, scenario=scenario) for scenario in grid(SCENARIO, {"sizes": sizes})]


@pytest.fixture(scope="module")
def several(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("several")
    evaluate(_jobs(0.75, 1.0), out, workers=1)
    return out


def test_every_condition_has_its_folder(several: Path) -> None:
    folders = {str(path.parent.relative_to(several)) for path in several.rglob("job.yaml")}
    assert folders == {SMALL, NORMAL}
    for folder in folders:
        assert len(list((several / folder / "rows").iterdir())) == 2


def test_records_have_every_episode_and_find_it_again(several: Path) -> None:
    records = read_records(several / "records.parquet").to_pylist()
    keys = [(r["folder"], r["size_ratio"], r["object"], r["set"], r["episode"]) for r in records]
    assert keys == [
        (folder, size, name, group, episode)
        for folder, size in ((SMALL, 0.75), (NORMAL, 1.0))
        for name, group in (("plate", "ood"), ("can_2", "id"))
        for episode in (0, 1)
    ]
    for record in records:
        assert (record["policy"], record["weights"]) == ("geometric", "")
        assert (record["seed"], record["outcome"], record["steps"]) == (1_000_000, "timed_out", 4)
        assert (record["com_shift"], record["cloud_deviation"]) == (0.0, 0.005)
        assert record["push_speed"] == SCENARIO.planner.push_speed
        rows = pq.read_table(
            several / record["folder"] / "rows" / f"{record['object']}-000000.parquet"
        )
        mine = [row for row in rows.to_pylist() if row["episode"] == record["episode"]]
        start, goal = ([record[f"{what}_{axis}"] for axis in "xy"] for what in ("start", "goal"))
        assert mine[0]["object_pose"][4:6] == pytest.approx(start, abs=1e-7)
        assert mine[0]["goal"] == pytest.approx(goal, abs=1e-7)
        assert mine[-1]["object_pose"][4] == pytest.approx(record["final_x"], abs=1e-3)


def test_the_report_tells_all_and_every_condition(several: Path) -> None:
    jobs = _jobs(0.75, 1.0)
    report = evaluation_report(SCENARIO, jobs, read_records(several / "records.parquet"))
    assert json.loads(json.dumps(report)) == report
    assert (report["policy"], report["seed"], report["episodes"]) == ("geometric", 1_000_000, 8)
    assert {name: line["episodes"] for name, line in report["sets"].items()} == {"ood": 4, "id": 4}
    small = report["conditions"]["size_0.75-shift_0-noise_0.005"]
    assert (small["object.size_ratio"], small["episodes"]) == (0.75, 4)
    assert small["objects"]["plate"]["failures"] == {"timed_out": 2}
    assert small["median_steps"] is None
    headings = [column.header for column in conditions_table(report["conditions"]).columns]
    assert headings[:2] == ["size", "episodes"]


def test_a_stopped_evaluation_ends_in_the_same_files(several: Path, tmp_path: Path) -> None:
    shutil.copytree(several, tmp_path, dirs_exist_ok=True)
    kept = tmp_path / SMALL / "episodes" / "plate-000000.parquet"
    before = kept.stat().st_mtime_ns
    (tmp_path / NORMAL / "episodes" / "can_2-000000.parquet").unlink()
    (tmp_path / "records.parquet").unlink()
    evaluate(_jobs(0.75, 1.0), tmp_path, workers=2)
    assert bytes_of(tmp_path) == bytes_of(several)
    assert kept.stat().st_mtime_ns == before


def test_conditions_may_be_added_but_not_left_out_or_mixed(several: Path, tmp_path: Path) -> None:
    shutil.copytree(several, tmp_path, dirs_exist_ok=True)
    with pytest.raises(UserError, match=r"size_1-shift_0-noise_0\.005: is no condition of this"):
        evaluate(_jobs(0.75, 1.25), tmp_path, workers=1)
    with pytest.raises(UserError, match="holds an evaluation of several conditions"):
        evaluate(_jobs(1.0), tmp_path, workers=1)
    more = evaluate(_jobs(0.75, 1.0, 1.25), tmp_path, workers=1)
    assert len(more) == 12


def test_one_condition_has_its_rows_in_the_folder_itself(several: Path, tmp_path: Path) -> None:
    records = evaluate(_jobs(1.0), tmp_path, workers=1)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"rows", "episodes", "scenario.yaml", "job.yaml", "records.parquet"}
    assert records["folder"].unique().to_pylist() == ["."]
    for kind in ("rows", "episodes"):
        assert bytes_of(tmp_path / kind) == bytes_of(several / NORMAL / kind)
    with pytest.raises(UserError, match="holds an evaluation of one condition"):
        evaluate(_jobs(0.75, 1.0), tmp_path, workers=1)
