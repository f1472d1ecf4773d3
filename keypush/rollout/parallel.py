"""Runs a job over processes; finished blocks stay, so a stopped job resumes."""

from pathlib import Path

from tqdm import tqdm

from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.job import Block, Job
from keypush.rollout.pool import Worker, WorkerPool
from keypush.rollout.store import EpisodeStore
from keypush.rollout.worker import BlockDone, EpisodeDone, MakeRunner


def run_job(
    job: Job, folder: Path, *, processes: int, make_runner: MakeRunner = EpisodeRunner
) -> EpisodeStore:
    """Runs the blocks of a job that its folder lacks.

    The files are the same, byte for byte, for any number of processes and any number of
    interruptions. A progress bar shows on a terminal.

    Args:
        job: what to run.
        folder: exists and can be written.
        processes: at most this many run at once, >= 1.
        make_runner: importable by name, since workers are new processes.

    Raises:
        UserError: the folder holds another job, or the scenario asks for what is not there.
        RuntimeError: an episode raised, or a process died.
    """
    store = EpisodeStore(folder)
    store.open(job)
    pending = [block for block in job.blocks() if not store.is_finished(block)]
    done = job.total - sum(block.count for block in pending)
    pool = WorkerPool(min(processes, len(pending)), job.scenario, folder, make_runner)
    try:
        with (
            tqdm(total=job.total, initial=done, unit="episode", disable=None) as bar,
            pool,
        ):
            _distribute(pool, pending, bar)
    finally:
        store.discard_partial_files()
    return store


def _distribute(pool: WorkerPool, pending: list[Block], bar: "tqdm[None]") -> None:
    successes = episodes = 0
    for worker in pool.workers:
        worker.start(_take(pending, worker))
    for worker, message in pool.messages():
        if isinstance(message, EpisodeDone):
            successes, episodes = successes + message.success, episodes + 1
            bar.set_postfix_str(f"success {successes}/{episodes}", refresh=False)
            bar.update()
        elif isinstance(message, BlockDone):
            worker.block = None
            if pending:
                worker.start(_take(pending, worker))


def _take(pending: list[Block], worker: Worker) -> Block:
    """Takes a block of the worker's object, or else of the object with most left to do."""
    names = [block.object for block in pending]
    name = worker.object if worker.object in names else max(names, key=names.count)
    return pending.pop(names.index(name))
