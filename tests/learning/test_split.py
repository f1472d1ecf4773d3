"""Which episodes are trained on, validated on and held out."""

import numpy as np
import pytest

from keypush.errors import UserError
from keypush.learning.config import DataConfig
from keypush.learning.rows import Rows, read_rows
from keypush.learning.split import split_rows
from tests.learning.synthetic import write_data


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    objects = [("can", 1.0), ("block", 1.0)]
    return read_rows(write_data(tmp_path_factory.mktemp("data"), objects, episodes=3))


@pytest.mark.parametrize("share", [0.01, 0.4, 0.9])
def test_episodes_are_left_for_both(share: float, rows: Rows) -> None:
    split = split_rows(rows, np.ones(len(rows), dtype=bool), DataConfig(validation_share=share))
    train, validation = (
        set(rows.episode[part.numpy()]) for part in (split.train, split.validation)
    )
    assert train
    assert validation
    assert not train & validation
    assert train | validation == set(rows.episode)


def test_no_episode_of_three_takes_them_all(rows: Rows) -> None:
    few = rows.episode < 3
    split = split_rows(rows, few, DataConfig(validation_share=0.9))
    assert len(set(rows.episode[split.train.numpy()])) == 1


def test_a_held_out_object_without_a_label_is_named(rows: Rows) -> None:
    names = np.array([name for name, _ in rows.objects])[rows.object_index]
    with pytest.raises(UserError, match="held_out_objects has can, of which no frame has a label"):
        split_rows(rows, names == "block", DataConfig(held_out_objects=["can"]))
    split = split_rows(rows, names != "", DataConfig(held_out_objects=["can"]))
    assert set(names[split.held_out.numpy()]) == {"can"}
