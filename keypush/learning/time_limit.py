"""A limit of wall time on a call that may never return."""

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

_AGAIN = 1.0
"""Time after which a limit that was caught is told again, s."""


class NoAnswer(BaseException):
    """The time is over; no `Exception`, which a loop that tries again would catch."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raises `NoAnswer` in what runs inside when its time is over.

    Only the main thread gets signals: elsewhere there is no limit. Compiled code is cut off when
    it comes back to Python. What catches everything gets it again every second, and once more
    after it has come to its end. Handler and timer are afterwards what they were before.

    Args:
        seconds: wall time.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    begun = time.monotonic()
    handler = signal.signal(signal.SIGALRM, _ring)
    left, interval = signal.setitimer(signal.ITIMER_REAL, seconds, _AGAIN)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        # None: set by other than Python, which cannot put it back.
        signal.signal(signal.SIGALRM, signal.SIG_DFL if handler is None else handler)
        if left:
            late = time.monotonic() - begun
            signal.setitimer(signal.ITIMER_REAL, max(left - late, 1e-6), interval)
    if time.monotonic() - begun > seconds:
        raise NoAnswer


def _ring(_number: int, _frame: FrameType | None) -> NoReturn:
    raise NoAnswer
