"""How many child processes there may be, and what they inherit: one thread each, and no Ctrl-C."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment variables that keep libraries of numbers to one thread."""


def usable_cores() -> int:
    """Returns how many cores this process may use: as many workers are started by default."""
    return len(os.sched_getaffinity(0))


@contextmanager
def worker_environment() -> Iterator[None]:
    """What processes started inside inherit: one thread each, and SIGINT blocked.

    Blocked before they start, Ctrl-C cannot reach workers even while they import; the
    parent, which gets it as well, ends them. One thread, because sums in another order
    would round differently, and because the processes fill the cores already.
    """
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    # Its first start unblocks SIGINT again, so it must not happen inside.
    resource_tracker.ensure_running()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
