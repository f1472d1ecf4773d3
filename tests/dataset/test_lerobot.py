"""Real LeRobot, in an environment of its own, loads data sets from a folder, without a network."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from keypush.dataset.arrays import to_array
from keypush.dataset.export import export_clouds
from keypush.dataset.features import CLOUD
from keypush.dataset.read import open_dataset

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("lerobot==0.4.4", "lerobot[dataset]==0.6.1")


def _run(*command: str | Path, folder: Path) -> None:
    offline = {"HF_HUB_OFFLINE": "1", "HF_HOME": str(folder / "hf"), "HOME": str(folder)}
    done = subprocess.run(
        command, env=os.environ | offline, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]


@pytest.fixture(scope="module", params=PACKAGES)
def python(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An interpreter with lerobot, which brings torch: gigabytes where they are not cached."""
    folder = tmp_path_factory.mktemp("lerobot")
    uv = ["sh", str(ROOT / "scripts" / "uv.sh")]
    python = folder / "venv" / "bin" / "python"
    for command in (
        ["venv", "--quiet", "--python", sys.executable, str(folder / "venv")],
        ["pip", "install", "--quiet", "--python", str(python), request.param],
    ):
        done = subprocess.run([*uv, *command], capture_output=True, text=True, check=False)
        assert done.returncode == 0, (
            f"{request.param} could not be installed, which needs a package index:\n"
            f"{done.stderr[-2000:]}"
        )
    return python


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("clouds", [False, True], ids=["as collected", "with clouds"])
def test_lerobot_loads_it(python: Path, real: Path, tmp_path: Path, clouds: bool) -> None:
    folder = real
    if clouds:
        folder = tmp_path / "clouds"
        export_clouds(open_dataset(real), folder)
    script = Path(__file__).with_name("load_with_lerobot.py")
    _run(python, script, folder, tmp_path / "loaded.npz", folder=tmp_path)
    loaded = np.load(tmp_path / "loaded.npz")
    dataset = open_dataset(folder)
    names = [feature.name for feature in dataset.features]
    frames = dataset.read(names)
    for feature in dataset.features:
        expected = to_array(frames[feature.name])
        found = loaded[feature.name]
        assert found.shape == expected.shape
        if feature.dtype == "float64":  # LeRobot makes float32 of it
            expected = expected.astype(np.float32)
        np.testing.assert_array_equal(found, expected)
    assert (CLOUD in names) is clouds
    np.testing.assert_array_equal(loaded["counts"], [64, 4, 2, 10])
    told = dataset.episodes.to_pylist()
    assert loaded["tasks"].tolist() == [task for e in told for task in e["tasks"] * e["length"]]
    lengths = [episode["length"] for episode in told]
    np.testing.assert_array_equal(loaded["chosen"], [lengths[1] + lengths[3], 2])
    actions = to_array(frames["action"])
    np.testing.assert_array_equal(loaded["first_pair"], actions[lengths[0] : lengths[0] + 2])
    np.testing.assert_array_equal(loaded["last_is_pad"], [False, True])
    state = to_array(frames["observation.state"])
    np.testing.assert_allclose(loaded["mean"], state.mean(axis=0), atol=1e-5)
