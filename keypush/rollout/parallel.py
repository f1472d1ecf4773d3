"""Runs a job on many workers; finished blocks stay, so a stopped job resumes."""

from collections import Counter
from pathlib import Path

from keypush.errors import UserError
from keypush.rollout.engine import Engine, Lost
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.job import Block, Job
from keypush.rollout.make_engine import EngineName, make_engine
from keypush.rollout.progress import Progress, say
from keypush.rollout.shard import Shard
from keypush.rollout.store import EpisodeStore
from keypush.rollout.worker import MakeRunner

_MOST_LOSSES = 2
"""Twice is no accident: the block itself ends its process."""


def run_job(
    job: Job,
    folder: Path,
    *,
    workers: int | None = None,
    engine: EngineName = "local",
    make_runner: MakeRunner = EpisodeRunner,
) -> EpisodeStore:
    """Runs the blocks of a job that its folder lacks.

    The files are the same, byte for byte, for any number of workers, either engine and any
    number of interruptions. A worker that the system kills is replaced and its block run again.
    A progress bar shows on a terminal.

    Args:
        job: what to run.
        folder: exists and can be written.
        workers: at most this many blocks run at once, >= 1; None: one per core.
        engine: where blocks run.
        make_runner: importable by name, since workers are new processes.

    Raises:
        UserError: the folder holds another job or a damaged file or cannot be written, the
            scenario asks for what is not there, or a block ended its process twice.
        RuntimeError: an episode raised.
    """
    store = EpisodeStore(folder)
    with hold_folder(folder):
        finished = store.open(job)
        pending = [block for block in job.blocks() if block not in finished]
        if pending:
            with make_engine(engine, workers, job.scenario, make_runner) as running:
                progress = Progress(job, finished)
                progress.announce(store, running.workers)
                with progress:
                    _run_blocks(running, pending, store, progress)
    return store


def _run_blocks(
    engine: Engine, pending: list[Block], store: EpisodeStore, progress: Progress
) -> None:
    losses: Counter[Block] = Counter()
    for block, event in engine.run(pending):
        if isinstance(event, Lost):
            losses[block] += 1
            if losses[block] == _MOST_LOSSES:
                raise UserError(
                    f"{block}: the process that ran it {event.how}, for the second time; "
                    f"{store.kept()}; allowed: fewer workers, more memory, the same command again"
                )
            progress.block_lost(block)
            say(f"{block}: the process that ran it {event.how}; another one runs it again")
        elif isinstance(event, Shard):
            store.write(block, event)
            progress.block_done(block, event)
        else:
            progress.episode_done(block, event.success)
