"""Data in which every episode has another size."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from keypush.learning.clouds import draw_clouds, surface_samplers
from keypush.learning.config import TrainingConfig
from keypush.learning.rows import read_rows
from keypush.learning.train import train
from keypush.objects.library import make_object
from tests.learning.scenes import SMALL
from tests.learning.synthetic import STEPS, write_data

SIZES = np.random.default_rng(0).uniform(0.75, 1.25, 25)
OBJECTS = [(name, float(size)) for name in ("can", "mug") for size in SIZES]
CONFIG = TrainingConfig(
    label="analytic", epochs=1, batch=16, cloud_points=64, clouds_per_object=4, network=SMALL
)


@pytest.fixture(scope="module")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_data(tmp_path_factory.mktemp("data"), OBJECTS, episodes=1)


def test_every_episode_keeps_its_own_size(data_dir: Path) -> None:
    rows = read_rows(data_dir)
    assert rows.objects == sorted(OBJECTS)
    assert len(np.unique(rows.episode)) == len(OBJECTS)
    np.testing.assert_array_equal(np.bincount(rows.object_index), STEPS)
    standing = [make_object(*rows.objects[i]).rest_height for i in rows.object_index]
    np.testing.assert_allclose(rows.object_pose[:, 6], standing, atol=1e-9)


def test_a_network_trains_on_it(data_dir: Path, tmp_path: Path) -> None:
    metrics = train(data_dir, tmp_path, CONFIG)
    assert metrics["validation"]["rows"] > 0
    assert np.isfinite(metrics["history"][0]["loss"])


@pytest.mark.parametrize(
    ("rows_per_epoch", "each"), [(20_000, 4), (200, 4), (199, 4), (150, 3), (101, 3), (1, 1)]
)
def test_no_more_clouds_are_drawn_than_a_pass_has_rows(rows_per_epoch: int, each: int) -> None:
    config = dataclasses.replace(CONFIG, rows_per_epoch=rows_per_epoch)
    bank = draw_clouds(surface_samplers(OBJECTS), config, np.random.default_rng(0))
    assert bank.per_object == each
    assert bank.cloud.shape == (each * len(OBJECTS), 64, 3)
