"""Runs every policy under every condition and writes the thesis' tables anew."""

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa

from keypush.errors import UserError
from keypush.evaluation.records import RECORDS_FILE, write_records
from keypush.reproduction.part import Part, parts
from keypush.reproduction.plan import Plan
from keypush.reproduction.report import TABLES_FILE, Reproduction, write_reproduction
from keypush.reproduction.throughput import Session, rate, read_sessions
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.make_engine import EngineName
from keypush.rollout.progress import SECONDS_PER_EPISODE, duration, say
from keypush.worker_environment import usable_cores


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

    Every policy under every condition is a part, an evaluation in OUT/POLICY/CONDITION of which
    the records stay. After each, `records.parquet`, `tables.md`, `summary.json` and `speed.md` in
    OUT tell of all that are finished.

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
    at_once = usable_cores() if workers is None else workers
    with hold_folder(out):
        todo = list(parts(plan, policies, out))
        _refuse_others(todo, out)
        _announce(todo, policies, at_once)
        tables: list[pa.Table] = []
        for number, part in enumerate(todo, 1):
            news = not part.finished
            if news:
                say(f"{part.name}, {number} of {len(todo)}")
            tables.append(part.run(workers=at_once, engine=engine))
            if not news and number < len(todo):
                continue
            reproduction = Reproduction(
                plan=plan,
                policies=policies,
                left=[later.name for later in todo[number:]],
                records=pa.concat_tables(tables),
                sessions={policy: _sessions(todo, policy) for policy in policies},
                ablation=ablation,
            )
            write_records(reproduction.records, out / RECORDS_FILE)
            write_reproduction(reproduction, out)
    return reproduction


def _refuse_others(todo: Sequence[Part], out: Path) -> None:
    """Keeps records that no reproduction wrote."""
    begun = (out / TABLES_FILE).exists() or any(part.folder.exists() for part in todo)
    if (out / RECORDS_FILE).exists() and not begun:
        raise UserError(
            f"output folder {out}: holds {RECORDS_FILE} of an evaluation; allowed: another folder"
        )


def _sessions(todo: Sequence[Part], policy: str) -> list[Session]:
    return [s for part in todo if part.policy == policy for s in read_sessions(part.folder)]


def _announce(todo: Sequence[Part], policies: Sequence[str], workers: int) -> None:
    """Says what is to be expected, from what was measured so far or from a constant."""
    left, seconds = 0, 0.0
    for policy in policies:
        mine = sum(part.left for part in todo if part.policy == policy)
        measured = rate(_sessions(todo, policy))
        left += mine
        seconds += mine / measured if measured else mine * SECONDS_PER_EPISODE / workers
    total = sum(part.job.total for part in todo)
    say(
        f"{left} of {total} episodes to run for {', '.join(policies)}: "
        f"about {duration(seconds)} with {workers} at once"
    )
