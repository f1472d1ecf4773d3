"""Trainings beside each other, in processes that neither Ctrl-C nor a crash can orphan."""

import io
import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from threading import Thread

from keypush.errors import UserError
from keypush.worker_environment import worker_environment

_LOOK_SECONDS = 1e-3


@contextmanager
def worker_pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Gives processes with one thread each, which start as tasks come and are ended on leaving.

    Args:
        workers: processes at most.
    """
    others = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_prepare)
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in set(multiprocessing.active_children()) - others:
            process.kill()  # Lightning would answer a gentler signal after its epoch
            process.join()
            while process.exitcode is None:  # the pool's own thread reaped it and is yet to say so
                time.sleep(_LOOK_SECONDS)


def run_all[Task, Answer](
    pool: ProcessPoolExecutor, work: Callable[[Task], Answer], tasks: Sequence[Task]
) -> Iterator[tuple[Task, Answer]]:
    """Yields tasks with their answers as they are done.

    Args:
        pool: of `worker_pool`.
        work: importable by name.
        tasks: to do.

    Raises:
        UserError: a task raised it, or the system ended a process.
    """
    with worker_environment():
        futures: dict[Future[Answer], Task] = {pool.submit(work, task): task for task in tasks}
    try:
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as error:
        raise UserError(
            "a training's process was ended by the system, often for lack of memory; finished "
            "trainings and epochs are kept; allowed: fewer workers, more memory, the same "
            "command again"
        ) from error


def _prepare() -> None:
    """Makes a process silent, and mortal: it ends with its parent."""
    sys.stdout = io.StringIO()  # no terminal, so no bars: they would write over each other
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end_with_parent() -> None:
        parent.join()
        os._exit(1)

    Thread(target=end_with_parent, daemon=True).start()
