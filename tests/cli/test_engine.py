"""`--engine ray` where there is no Ray: one line says what is missing."""

import os
import subprocess
import sys
from pathlib import Path

from tests.cli.command import KEYPUSH

ARGUMENTS = ("collect", "--objects", "plate", "--episodes-per-object", "1", "--engine", "ray")


def _collect(command: list[str], folder: Path, **environment: str) -> str:
    result = subprocess.run(
        [*command, *ARGUMENTS, "--out", folder],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert result.returncode == 2, result.stderr
    assert result.stderr.count("\n") == 1
    return result.stderr


def test_the_missing_extra_is_named(tmp_path: Path) -> None:
    # What Python does where a package is not installed.
    program = (
        "import sys; sys.modules['ray'] = None; from keypush.cli.main import main; exit(main())"
    )
    assert "pip install keypush[ray]" in _collect([sys.executable, "-c", program], tmp_path)


def test_a_cluster_that_does_not_answer_is_named(tmp_path: Path) -> None:
    errors = _collect([str(KEYPUSH)], tmp_path, RAY_ADDRESS="127.0.0.1:9")
    assert "no cluster answers at RAY_ADDRESS=127.0.0.1:9" in errors
