"""Where one thread spends its time, looked up a few hundred times a second."""

import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_PERIOD = 2e-3
"""s."""
_SWITCH = 1e-4
"""s; Python's own 5 ms are longer than most callbacks: they would be over before anyone looked."""

Classify = Callable[[FrameType], str]


@contextmanager
def sampled(classify: Classify) -> Iterator[Counter[str]]:
    """Counts what the calling thread is at while the block runs.

    Drake's `AdvanceTo` lets other threads run: time in C++ counts as well as that in Python.

    Args:
        classify: names what the thread's innermost frame, with those around it, is at.

    Yields:
        How often each name was found; complete after the block.
    """
    found: Counter[str] = Counter()
    done, watched = threading.Event(), threading.get_ident()

    def look() -> None:
        while not done.wait(_PERIOD):
            found[classify(sys._current_frames()[watched])] += 1

    before = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH)
    watcher = threading.Thread(target=look)
    watcher.start()
    try:
        yield found
    finally:
        done.set()
        watcher.join()
        sys.setswitchinterval(before)
