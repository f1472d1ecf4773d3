"""Which rows teach what."""

import dataclasses

import numpy as np
import pytest

from keypush.errors import UserError
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.presets import preset_config
from keypush.learning.imitation.selection import select_rows
from keypush.learning.imitation.targets import make_targets
from keypush.learning.labels import make_labels
from keypush.learning.rows import Rows
from keypush.networks.normalisation import denormalise_positions
from keypush.planning.plan_state import Stage
from tests.learning.imitation.sample import CLIPS, sample_rows

CONFIG = ImitationConfig(rows_per_object=50, held_out_objects=["mug", "shoe"])


@pytest.fixture(scope="module")
def rows() -> Rows:
    return sample_rows()


@pytest.mark.parametrize("label", ["measured", "analytic"])
def test_keypoints_are_the_labels_normalised(rows: Rows, label: str) -> None:
    config = dataclasses.replace(CONFIG, label=label)
    targets = make_targets("keypoint", rows, CLIPS, config)
    assert np.nanmax(np.abs(targets)) < 1
    np.testing.assert_allclose(denormalise_positions(targets), make_labels(rows, label), atol=1e-12)


def test_actions_are_shares_of_their_clips(rows: Rows) -> None:
    targets = make_targets("behavior_cloning", rows, CLIPS, CONFIG)
    taught = np.isfinite(targets).all(axis=1)
    assert np.abs(targets[taught]).max() == 1.0  # far away the expert asks for more than it may
    small = taught & (np.abs(rows.action) < [0.06] * 3 + [0.1] * 3).all(axis=1)
    scaled = targets[small] * ([0.06] * 3 + [0.1] * 3)
    np.testing.assert_allclose(scaled, rows.action[small], atol=1e-9)
    last = np.append(rows.episode[1:] != rows.episode[:-1], True)
    assert not (taught & (last | np.isin(rows.stage, [Stage.RETREAT, Stage.HALTED]))).any()


def test_retreats_are_cloned_when_wanted(rows: Rows) -> None:
    retreats = rows.stage == Stage.RETREAT
    stages = np.where(np.arange(len(rows)) % 7 == 3, int(Stage.RETREAT), rows.stage)
    rows = dataclasses.replace(rows, stage=stages)
    config = dataclasses.replace(CONFIG, retreats=True)
    counts = [
        np.isfinite(make_targets("behavior_cloning", rows, CLIPS, c)).all(axis=1).sum()
        for c in (CONFIG, config)
    ]
    assert counts[1] - counts[0] > 1000
    assert retreats.sum() < counts[1]


def test_every_object_is_drawn_as_often_and_no_episode_twice(rows: Rows) -> None:
    usable = np.isfinite(make_labels(rows, "measured")).all(axis=1)
    selection = select_rows(rows, usable, CONFIG)
    assert len(np.unique(selection.rows)) == len(selection.rows)
    assert (np.diff(rows.object_index[selection.rows]) >= 0).all()
    names = np.array([name for name, _ in rows.objects])[rows.object_index]
    train = selection.rows[selection.train]
    counts = dict(zip(*np.unique(names[train], return_counts=True), strict=True))
    assert set(counts.values()) == {50}
    assert set(counts) == set(names) - {"mug", "shoe"}
    assert set(selection.held_out) == {"mug", "shoe"}
    assert set(names[selection.rows[selection.held_out["mug"]]]) == {"mug"}
    validation = selection.rows[selection.validation]
    assert not set(rows.episode[train]) & set(rows.episode[validation])
    assert usable[selection.rows].all()


def test_no_limit_takes_every_row(rows: Rows) -> None:
    usable = np.isfinite(make_labels(rows, "measured")).all(axis=1)
    selection = select_rows(rows, usable, dataclasses.replace(CONFIG, rows_per_object=0))
    parts = [selection.train, selection.validation, *selection.held_out.values()]
    assert sum(map(len, parts)) == usable.sum()


def test_presets_leave_what_is_given() -> None:
    thesis = preset_config(ImitationConfig(epochs=3), "thesis")
    assert (thesis.epochs, thesis.batch, thesis.learning_rate) == (3, 64, 4e-4)
    assert not thesis.cache
    assert preset_config(ImitationConfig(batch=7), "thesis").batch == 7
    assert preset_config(ImitationConfig(), "affordable") == ImitationConfig()
    with pytest.raises(UserError, match="preset is 'quick'; allowed: affordable, thesis"):
        preset_config(ImitationConfig(), "quick")
