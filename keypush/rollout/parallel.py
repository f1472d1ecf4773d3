"""Runs jobs on many workers; finished episodes stay, so a stopped job resumes."""

from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from keypush.errors import UserError
from keypush.rollout.engine import Engine, Lost
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.job import Block, Job
from keypush.rollout.make_engine import EngineName, make_engine
from keypush.rollout.progress import Progress, say
from keypush.rollout.store import EpisodeStore
from keypush.rollout.worker import MakeRunner

_MOST_LOSSES = 2
"""Twice is no accident: the episode itself ends its process."""


def run_job(
    job: Job,
    folder: Path,
    *,
    workers: int | None = None,
    engine: EngineName = "local",
    make_runner: MakeRunner = EpisodeRunner,
) -> EpisodeStore:
    """Runs the episodes of a job that its folder lacks.

    The files are the same, byte for byte, for any number of workers, either engine and any
    number of interruptions. A worker that the system kills is replaced and its episode run again.
    A progress bar shows on a terminal.

    Args:
        job: what to run.
        folder: exists and can be written.
        workers: at most this many blocks run at once, >= 1; None: one per core.
        engine: where blocks run.
        make_runner: importable by name, since workers are new processes.

    Raises:
        UserError: the folder holds another job or a damaged file or cannot be written, the
            scenario asks for what is not there, or an episode ended its process twice.
        RuntimeError: an episode raised.
    """
    (store,) = run_jobs([(job, folder)], workers=workers, engine=engine, make_runner=make_runner)
    return store


def run_jobs(
    jobs: Sequence[tuple[Job, Path]],
    *,
    workers: int | None = None,
    engine: EngineName = "local",
    make_runner: MakeRunner = EpisodeRunner,
) -> list[EpisodeStore]:
    """Runs jobs as `run_job` does, each in its folder, all on the same workers.

    No worker waits for a job's last blocks while another job has some. One bar shows all.

    Returns:
        The store of each job.
    """
    stores = [EpisodeStore(folder) for _, folder in jobs]
    with ExitStack() as held:
        for _, folder in jobs:
            held.enter_context(hold_folder(folder))
        found = [
            store.open(job, index)
            for index, ((job, _), store) in enumerate(zip(jobs, stores, strict=True))
        ]
        pending = [block for tally in found for block in tally.missing]
        if pending:
            each = [job for job, _ in jobs]
            running = held.enter_context(make_engine(engine, workers, each, make_runner))
            progress = Progress(sum(job.total for job, _ in jobs), found)
            progress.announce(jobs[0][1], running.workers)
            with progress:
                _run_blocks(running, pending, stores, progress)
    return stores


def _run_blocks(
    engine: Engine, pending: list[Block], stores: Sequence[EpisodeStore], progress: Progress
) -> None:
    losses: Counter[Block] = Counter()
    for block, event in engine.run(pending):
        if isinstance(event, Lost):
            losses[block] += 1
            if losses[block] == _MOST_LOSSES:
                raise UserError(
                    f"{block}: the process that ran it {event.how}, for the second time; "
                    f"{stores[block.job].kept()}; "
                    "allowed: fewer workers, more memory, the same command again"
                )
            say(f"{block}: the process that ran it {event.how}; another one runs it again")
        else:
            stores[block.job].write(block, event.shard)
            progress.episode_done(event.shard)
