"""What a card tells of how weights came about."""

import dataclasses
import hashlib
import subprocess
import sys
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from keypush.learning.rows import Rows
from keypush.learning.run_config import RunConfig


def training_record(
    parameters: int, data: Mapping[str, Any], config: RunConfig, metrics: Mapping[str, Any]
) -> dict[str, Any]:
    """Tells how weights came about, for their card.

    Args:
        parameters: how many numbers were learned.
        data: what was trained on.
        config: settings of the training.
        metrics: what was measured.
    """
    return {
        "parameters": parameters,
        "git_revision": git_revision(),
        "command": command_line(),
        "data": dict(data),
        "training": dataclasses.asdict(config),
        "metrics": dict(metrics),
    }


def data_record(rows: Rows, digest: str, held_out: Collection[str]) -> dict[str, Any]:
    """Tells what was read, and which of its objects were trained on.

    Args:
        rows: all rows, those of objects that were only measured on among them.
        digest: of what the rows teach.
        held_out: these objects.
    """
    return {
        "rows": len(rows),
        "episodes": len(np.unique(rows.episode)),
        "objects": sorted({name for name, _ in rows.objects}.difference(held_out)),
        "held_out_objects": sorted(held_out),
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
    """Returns the words of the command that runs; cards travel, so paths of this machine do not."""
    return [Path(sys.argv[0]).name, *(_portable(word) for word in sys.argv[1:])]


def _portable(word: str) -> str:
    """Returns an absolute path as seen from here, or its name alone where it lies elsewhere."""
    path = Path(word)
    if not path.is_absolute():
        return word
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else path.name


def git_revision() -> str:
    """The revision of the code, or "unknown" outside a checkout of it."""
    here = Path(__file__)
    try:
        # An environment may lie inside somebody else's checkout.
        _git(here.parent, "ls-files", "--error-unmatch", here.name)
        return _git(here.parent, "rev-parse", "HEAD")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _git(folder: Path, *words: str) -> str:
    command = ["git", "-C", str(folder), *words]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
