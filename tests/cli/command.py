"""Runs the installed `keypush` command as a user does."""

import subprocess
import sys
from pathlib import Path

KEYPUSH = Path(sys.executable).with_name("keypush")


def keypush(*arguments: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs `keypush ARGUMENTS` to its end."""
    return subprocess.run(
        [KEYPUSH, *arguments], cwd=cwd, capture_output=True, text=True, check=False, timeout=100
    )
