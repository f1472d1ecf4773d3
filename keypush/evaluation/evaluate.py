"""An evaluation: jobs that differ in their condition alone, run together into one folder."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import yaml

from keypush.atomic_file import make_folder, write_whole
from keypush.errors import UserError
from keypush.evaluation.conditions import AXES, condition_name
from keypush.evaluation.measures import job_records
from keypush.evaluation.records import RECORDS_FILE, read_records, write_records
from keypush.evaluation.summary import Summary, summarise, summarise_group
from keypush.policies import policy_label
from keypush.rollout.job import Job
from keypush.rollout.make_engine import EngineName
from keypush.rollout.parallel import run_jobs
from keypush.rollout.start_check import check_starts
from keypush.scenario import Scenario, dump_scenario

CONDITIONS = "conditions"
"""Holds a folder for each condition, where there are several."""
SUMMARY_FILE = "summary.json"
_ONE_FOLDER = "."
"""Stands in the records for the folder of the evaluation itself."""


def evaluate(
    jobs: Sequence[Job], out: Path, *, workers: int | None = None, engine: EngineName = "local"
) -> pa.Table:
    """Runs an evaluation, or goes on with one that was stopped, and writes its records.

    With one job OUT/rows and OUT/episodes hold its episodes; with several each has its folder in
    OUT/conditions. Conditions may be added to a finished evaluation of several.

    Args:
        jobs: one for each condition; conditions differ.
        out: exists and can be written.
        workers: see `run_job`, as engine.
        engine: see there.

    Returns:
        The records, see `RECORDS`, in the order of jobs, objects and episodes.

    Raises:
        UserError: the folder holds something else, an object has no start, or see `run_job`.
        RuntimeError: an episode raised.
    """
    run_conditions(jobs, out, workers=workers, engine=engine)
    return collect_records(jobs, out)


def run_conditions(
    jobs: Sequence[Job], out: Path, *, workers: int | None = None, engine: EngineName = "local"
) -> None:
    """Runs what an evaluation lacks; see `evaluate`."""
    folders = condition_folders(jobs)
    _refuse_others(out, folders)
    for job in jobs:
        check_starts(job)
    for folder in folders:
        make_folder(out / folder)
    places = [(job, out / folder) for job, folder in zip(jobs, folders, strict=True)]
    run_jobs(places, workers=workers, engine=engine)


def collect_records(jobs: Sequence[Job], out: Path) -> pa.Table:
    """Makes `records.parquet` of an evaluation that has been run; see `evaluate`."""
    records = [
        record
        for job, folder in zip(jobs, condition_folders(jobs), strict=True)
        for record in job_records(job, out / folder, folder)
    ]
    write_records(records, out / RECORDS_FILE)
    return read_records(out / RECORDS_FILE)


def condition_folders(jobs: Sequence[Job]) -> list[str]:
    """Returns where the episodes of each job lie, relative to the evaluation's folder."""
    if len(jobs) == 1:
        return [_ONE_FOLDER]
    return [f"{CONDITIONS}/{condition_name(job.scenario)}" for job in jobs]


def evaluation_report(scenario: Scenario, jobs: Sequence[Job], records: pa.Table) -> dict[str, Any]:
    """Returns what `summary.json` holds.

    Args:
        scenario: of all jobs, but for what their conditions say.
        jobs: as they were evaluated.
        records: of their episodes.
    """
    episodes = records.to_pylist()
    sets = dict.fromkeys(episode["set"] for episode in episodes)
    return {
        "policy": policy_label(scenario.policy),
        "weights": episodes[0]["weights"],
        "seed": scenario.seed,
        **summarise(episodes),
        "sets": {name: summarise_group([e for e in episodes if e["set"] == name]) for name in sets},
        "conditions": _conditions(jobs, episodes),
        "scenario": yaml.safe_load(dump_scenario(scenario)),
    }


def write_report(report: dict[str, Any], out: Path) -> Path:
    """Writes `summary.json`; returns its path.

    Raises:
        UserError: it cannot be written.
    """
    path = out / SUMMARY_FILE
    write_whole(path, (json.dumps(report, indent=2) + "\n").encode())
    return path


def _conditions(jobs: Sequence[Job], episodes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for job, folder in zip(jobs, condition_folders(jobs), strict=True):
        mine: Summary = summarise([e for e in episodes if e["folder"] == folder])
        fields = {axis.name: axis.value(job.scenario) for axis in AXES}
        found[condition_name(job.scenario)] = {**fields, **mine}
    return found


def _refuse_others(out: Path, folders: Sequence[str]) -> None:
    """Refuses to mix one condition with several, and conditions that are not asked for.

    Records without what they came from would be lost.
    """
    several = folders != [_ONE_FOLDER]
    if (out / RECORDS_FILE).exists() and not any(
        (out / name).exists() for name in ("job.yaml", CONDITIONS)
    ):
        raise UserError(
            f"output folder {out}: holds {RECORDS_FILE} of another evaluation; allowed: another "
            "folder"
        )
    if several and (out / "job.yaml").exists():
        raise UserError(
            f"output folder {out}: holds an evaluation of one condition (job.yaml); allowed: "
            "another folder, or that condition alone"
        )
    if not several and (out / CONDITIONS).exists():
        raise UserError(
            f"output folder {out}: holds an evaluation of several conditions ({CONDITIONS}/); "
            "allowed: another folder, or all of them"
        )
    for found in sorted((out / CONDITIONS).glob("*")):
        if f"{CONDITIONS}/{found.name}" not in folders:
            raise UserError(
                f"{found}: is no condition of this evaluation; allowed: the conditions that are "
                "there and more, or another output folder"
            )
