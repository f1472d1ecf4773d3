"""What a card tells of how weights came about."""

import hashlib
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from keypush.learning.rows import Rows


def data_record(rows: Rows, digest: str) -> dict[str, Any]:
    """Tells what was trained on; `digest` is of what the rows teach."""
    return {
        "rows": len(rows),
        "episodes": len(np.unique(rows.episode)),
        "objects": sorted({name for name, _ in rows.objects}),
        "sha256": digest,
        "seeds": list(rows.seeds),
    }


def digest_of(arrays: Iterable[NDArray[Any]]) -> str:
    """Returns a hash of arrays."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def command_line() -> list[str]:
    """Returns the words of the command that runs."""
    return [Path(sys.argv[0]).name, *sys.argv[1:]]


def git_revision() -> str:
    """The revision of the code, or "unknown" outside a checkout."""
    try:
        command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()
