"""What must hold for the repository as a whole."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_imports_flow_one_way() -> None:
    command = Path(sys.executable).with_name("lint-imports")
    result = subprocess.run(
        [command, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout


def test_every_module_has_a_layer() -> None:
    """A module that the contract does not name could import anything."""
    config = tomllib.loads((ROOT / "pyproject.toml").read_text())
    layers = config["tool"]["importlinter"]["contracts"][0]["layers"]
    named = {name.strip() for layer in layers for name in layer.split(":")}
    modules = {
        f"keypush.{path.stem}"
        for path in (ROOT / "keypush").iterdir()
        if (path / "__init__.py").exists() or (path.suffix == ".py" and path.stem != "__init__")
    }
    assert named == modules | {"diagrams"}


def _tracked_text_files() -> list[Path]:
    try:
        listing = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("needs git and a checkout")
    files = [ROOT / name for name in listing.split("\0") if name and name != "uv.lock"]
    return [path for path in files if path.is_file() and b"\0" not in path.read_bytes()[:8000]]


# Split, so that this file passes its own test.
@pytest.mark.parametrize(
    "pattern",
    [
        r"(?<![\w.~])/(?:ro" + r"ot|ho" + r"me|wo" + r"rk|Us" + r"ers)/\w",
        r"py" + r"pi\.org|python" + r"hosted|npm" + r"js\.|crates" + r"\.io|deb" + r"ian\.org",
    ],
    ids=["paths of one machine", "hosts of package registries"],
)
def test_no_tracked_file_names(pattern: str) -> None:
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}"
        for path in _tracked_text_files()
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1)
        if re.search(pattern, line)
    ]
    assert found == []
