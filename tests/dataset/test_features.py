"""The table of fields, and docs/dataset.md, which tells of them."""

import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from keypush.dataset.arrays import to_array, to_column
from keypush.dataset.features import CLOUD, FEATURES, arrow_schema, cloud_feature
from keypush.dataset.layout import EPISODE_COLUMNS
from tests.dataset.real_shards import OBJECTS, results

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "dataset.md").read_text(encoding="utf-8")
LEROBOT = ("timestamp", "frame_index", "episode_index", "index", "task_index")


def _table(heading: str) -> dict[str, list[str]]:
    """The rows of the table below a heading, by their first cell."""
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = [line.strip("| \n").split(" | ") for line in section.splitlines() if line[:2] == "| "]
    return {row[0].strip("` "): [cell.strip() for cell in row[1:]] for row in rows[2:]}


def test_the_page_tells_of_every_field() -> None:
    told = _table("Fields of a frame")
    every = (*FEATURES, cloud_feature(512))
    assert list(told) == [feature.name for feature in every]
    for feature in every:
        shape = " x ".join(map(str, feature.shape))
        expected = [shape, feature.dtype, feature.frame, feature.unit, feature.meaning]
        assert told[feature.name] == expected


def test_the_page_tells_of_every_column_of_the_episodes() -> None:
    summary = results(OBJECTS[0])[0].summary
    told = {name for cell in _table("Columns of an episode") for name in cell.split("`, `")}
    assert told >= {*EPISODE_COLUMNS.names, *summary}


def test_the_page_names_nothing_that_is_not_there() -> None:
    known = {feature.name for feature in FEATURES} | {CLOUD}
    named = set(re.findall(r"`((?:observation|contact|next)\.\w+)`", PAGE))
    assert named <= known


def test_names_fit_shapes_and_lerobots_fields_are_there() -> None:
    names = [feature.name for feature in FEATURES]
    assert len(set(names)) == len(names)
    assert tuple(names[-5:]) == LEROBOT
    assert all("/" not in name for name in names)
    for feature in FEATURES:
        assert feature.names is None or len(feature.names) == feature.shape[0]
    assert arrow_schema(FEATURES).field("observation.object_pose").type == pa.list_(pa.float64(), 7)


@pytest.mark.parametrize("feature", [*FEATURES, cloud_feature(4)], ids=lambda f: f.name)
def test_columns_hold_what_arrays_hold(feature) -> None:  # type: ignore[no-untyped-def]  # Feature
    shape = () if feature.shape == (1,) else feature.shape
    values = np.random.default_rng(0).integers(0, 2, (5, *shape)).astype(feature.dtype)
    column = to_column(values, feature.arrow_type)
    assert column.type == feature.arrow_type
    found = to_array(pa.chunked_array([column.slice(0, 2), column.slice(2)]))
    np.testing.assert_array_equal(found, values)
    assert found.dtype == feature.dtype
