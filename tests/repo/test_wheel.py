"""The wheel works away from the checkout."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_an_installed_wheel_runs_the_demo(tmp_path: Path) -> None:
    uv = os.environ.get("UV") or shutil.which("uv")  # `uv run` sets UV to its own path.
    assert uv, "run by `make test-slow`, which brings uv"
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}

    def run(*command: str | Path, cwd: Path) -> str:
        return subprocess.run(
            command, cwd=cwd, env=environment, check=True, capture_output=True, text=True
        ).stdout

    venv = tmp_path / "venv"
    locked = tmp_path / "requirements.txt"
    run(uv, "build", "--wheel", "--out-dir", tmp_path, cwd=ROOT)
    run(uv, "export", "--frozen", "--no-dev", "--no-emit-project", "-o", locked, cwd=ROOT)
    run(uv, "venv", "--python", sys.executable, venv, cwd=tmp_path)
    python = venv / "bin" / "python"
    run(uv, "pip", "install", "--python", python, "-r", locked, cwd=tmp_path)
    wheel = next(tmp_path.glob("keypush-*.whl"))
    run(uv, "pip", "install", "--python", python, "--no-deps", wheel, cwd=tmp_path)

    where = run(python, "-c", "import keypush, diagrams; print(keypush.__file__)", cwd=tmp_path)
    assert Path(where.strip()).is_relative_to(venv)
    told = run(venv / "bin" / "keypush", "demo", "--out", "demo", cwd=tmp_path)
    assert "pushes the mug" in told
    for name in ("summary.json", "scenario.yaml", "recording.html"):
        assert (tmp_path / "demo" / name).stat().st_size > 0
