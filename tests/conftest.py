"""Settings for every test."""

import os

# Tests run beside each other; threads of one would only slow the others down. NumPy and torch
# read this when they are imported, so it stands before any test is.
os.environ.setdefault("OMP_NUM_THREADS", "1")
