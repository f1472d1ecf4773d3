"""A data set: its shards are collected, then assembled, and can be resumed at any point."""

import os
import shutil
from pathlib import Path
from typing import Any

from keypush.atomic_file import make_folder
from keypush.dataset.assemble import assemble_dataset, frames_per_second
from keypush.dataset.layout import INFO
from keypush.errors import UserError, one_line
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.job import Job
from keypush.rollout.make_engine import EngineName
from keypush.rollout.parallel import run_job
from keypush.rollout.progress import say
from keypush.rollout.start_check import check_starts
from keypush.rollout.store import compare_description
from keypush.rollout.worker import MakeRunner

SHARDS = "collecting"
"""Where the shards lie while there is no data set yet, below its folder."""


def collect_dataset(
    job: Job,
    out: Path,
    *,
    workers: int | None = None,
    engine: EngineName = "local",
    make_runner: MakeRunner = EpisodeRunner,
) -> list[dict[str, Any]] | None:
    """Collects a data set, or goes on with one that was stopped.

    Args:
        job: what to run.
        out: exists and can be written.
        workers: see `run_job`, as the others.
        engine: see there.
        make_runner: see there.

    Returns:
        The summaries of all episodes; None if the data set was complete already.

    Raises:
        UserError: the folder holds another data set or something else, an object has no start,
            or see `run_job` and `assemble_dataset`.
        RuntimeError: an episode raised.
    """
    shards = out / SHARDS
    with hold_folder(out):
        _refuse_others(job, out)
        if (out / INFO).exists():
            _discard(shards)
            return None
        frames_per_second(job.scenario.episode.policy_period)
        check_starts(job)
        make_folder(shards)
        store = run_job(job, shards, workers=workers, engine=engine, make_runner=make_runner)
        summaries = store.read_summaries()
        _assemble(shards, out)
    return summaries


def _refuse_others(job: Job, out: Path) -> None:
    """Looks now for what would be in the data set's way in the end, hours later."""
    if (out / "job.yaml").exists():
        raise UserError(
            f"output folder {out}: holds episodes of another kind of run (job.yaml); "
            "allowed: a new folder, or one of `keypush collect`"
        )
    if (out / "data").exists() or (out / "meta").exists():
        compare_description(job, out / "meta")


def _assemble(shards: Path, out: Path) -> None:
    say(f"all episodes are there; writing the data set to {out}")
    try:
        assemble_dataset(shards, out)
    except OSError as error:
        raise UserError(
            f"{out}: the data set cannot be written: {error.strerror or one_line(error)}; all "
            f"episodes are kept in {shards}, and the same command goes on from them"
        ) from error
    os.sync()  # A loss of power must not take the data set after its shards are gone.
    _discard(shards)


def _discard(shards: Path) -> None:
    """Removes what the data set holds by now; also what a stopped run left of it."""
    if shards.exists():
        shutil.rmtree(shards)
