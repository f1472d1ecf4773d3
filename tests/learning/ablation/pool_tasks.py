"""What worker processes of `test_pool` do."""

import multiprocessing
import os
import signal
import sys
import time

import numpy as np

from keypush.errors import UserError


def square(number: int) -> tuple[int, bool]:
    """Returns the square, and whether it was computed elsewhere and in silence."""
    elsewhere = multiprocessing.parent_process() is not None
    silent = not sys.stdout.isatty() and os.environ["OMP_NUM_THREADS"] == "1"
    return int(np.square(number)), elsewhere and silent


def be_killed(number: int) -> int:
    """Ends its process as a system without memory does, if it is told 1."""
    if number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def complain(number: int) -> int:
    """Fails by a mistake of the user's."""
    raise UserError(f"number is {number}; allowed: none")


def wait(number: int) -> int:
    """Takes long, unless it is told 0."""
    time.sleep(600 * number)
    return number
