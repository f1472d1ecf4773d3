"""Settings for every test."""

import os

from hypothesis import settings

# Tests run beside each other; threads of one would only slow the others down. NumPy and torch
# read this when they are imported, so it stands before any test is.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# A deadline would fail on a busy machine; the same examples in every run.
settings.register_profile("keypush", deadline=None, derandomize=True)
settings.load_profile("keypush")
