"""Data sets that the tests of this folder share; they must not be changed."""

import shutil
from pathlib import Path

import pytest

from keypush.dataset.assemble import assemble_dataset
from tests.dataset.real_shards import write_real_shards
from tests.learning.synthetic import write_data


@pytest.fixture(scope="session")
def synthetic(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three objects with three episodes each, all labelled; the first of each fails."""
    objects = [("can", 0.75), ("block", 1.0), ("mug", 1.25)]
    return write_data(tmp_path_factory.mktemp("synthetic"), objects, episodes=3, failures=1)


@pytest.fixture(scope="session")
def real_shards(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_real_shards(tmp_path_factory.mktemp("shards"))


@pytest.fixture(scope="session")
def real(tmp_path_factory: pytest.TempPathFactory, real_shards: Path) -> Path:
    """Two objects with two short simulated episodes each."""
    out = tmp_path_factory.mktemp("real")
    assemble_dataset(real_shards, out)
    return out


@pytest.fixture
def copy(synthetic: Path, tmp_path: Path) -> Path:
    """A data set that a test may damage."""
    for name in ("data", "meta"):
        shutil.copytree(synthetic / name, tmp_path / "copy" / name)
    return tmp_path / "copy"
