"""Runs every policy under every condition and writes the thesis' tables anew."""

import os
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa

from keypush.evaluation.evaluate import (
    collect_records,
    evaluation_report,
    run_conditions,
    write_report,
)
from keypush.evaluation.records import RECORDS_FILE, write_records
from keypush.reproduction.plan import Plan
from keypush.reproduction.report import Reproduction, write_reproduction
from keypush.reproduction.throughput import finished_episodes, rate, read_sessions, timed
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.make_engine import EngineName
from keypush.rollout.progress import SECONDS_PER_EPISODE, duration, say


def reproduce(
    plan: Plan,
    policies: Sequence[str],
    out: Path,
    *,
    workers: int | None = None,
    engine: EngineName = "local",
    ablation: str | None = None,
) -> Reproduction:
    """Reproduces the tables, or goes on where it was stopped.

    Each policy has its evaluation in OUT/POLICY. After each, `records.parquet`, `tables.md` and
    `summary.json` in OUT tell of all that are finished.

    Args:
        plan: what to run of each policy.
        policies: checked by `check_policies`.
        out: exists and can be written.
        workers: see `run_job`, as engine.
        engine: see there.
        ablation: what `tables.md` says of the ablation; None where none is given.

    Raises:
        UserError: see `evaluate`.
        RuntimeError: an episode raised.
    """
    at_once = len(os.sched_getaffinity(0)) if workers is None else workers
    with hold_folder(out):
        _announce(plan, policies, out, at_once)
        tables: list[pa.Table] = []
        for number, policy in enumerate(policies, 1):
            say(f"{policy}, policy {number} of {len(policies)}")
            tables.append(_evaluate(plan, policy, out, workers, engine, at_once))
            records = pa.concat_tables(tables)
            write_records(records, out / RECORDS_FILE)
            reproduction = Reproduction(
                plan=plan,
                policies=policies[:number],
                left=policies[number:],
                records=records,
                sessions={name: read_sessions(out / name) for name in policies[:number]},
                ablation=ablation,
            )
            write_reproduction(reproduction, out)
    return reproduction


def _evaluate(
    plan: Plan, policy: str, out: Path, workers: int | None, engine: EngineName, at_once: int
) -> pa.Table:
    """Evaluates a policy in its folder; returns its records with folders relative to `out`."""
    jobs, mine = plan.jobs(policy), out / policy
    mine.mkdir(exist_ok=True)
    with timed(jobs, mine, at_once):
        run_conditions(jobs, mine, workers=workers, engine=engine)
    records = collect_records(jobs, mine)
    write_report(evaluation_report(jobs[0].scenario, jobs, records), mine)
    folders = [f"{policy}/{folder}" for folder in records["folder"].to_pylist()]
    place = records.schema.get_field_index("folder")
    return records.set_column(place, records.schema.field(place), pa.array(folders))


def _announce(plan: Plan, policies: Sequence[str], out: Path, workers: int) -> None:
    """Says what is to be expected, from what was measured so far or from a constant."""
    left, seconds = 0, 0.0
    for policy in policies:
        mine = plan.total - finished_episodes(plan.jobs(policy), out / policy)
        measured = rate(read_sessions(out / policy))
        left += mine
        seconds += mine / measured if measured else mine * SECONDS_PER_EPISODE / workers
    total = plan.total * len(policies)
    say(
        f"{left} of {total} episodes to run for {', '.join(policies)}: "
        f"about {duration(seconds)} with {workers} at once"
    )
