"""Statistics of fields: against NumPy on the whole, and joined in any order of episodes."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from hypothesis import given
from hypothesis import strategies as st

from keypush.dataset.arrays import to_array
from keypush.dataset.episode_stats import STATS, TotalStats, episode_stats
from keypush.dataset.features import FEATURES
from keypush.dataset.read import open_dataset


@given(st.integers(0, 2**32), st.lists(st.integers(1, 30), min_size=1, max_size=6), st.booleans())
def test_joined_statistics_are_those_of_the_whole(
    seed: int, lengths: list[int], gaps: bool
) -> None:
    rng = np.random.default_rng(seed)
    parts = [rng.normal(rng.normal(scale=10), 2.0, (n, 3)) for n in lengths]
    if gaps:
        for part in parts:
            part[rng.random(len(part)) < 0.5] = np.nan
    total = TotalStats()
    for part in parts:
        total.add(episode_stats(part))
    whole = np.vstack(parts)
    whole = whole[np.isfinite(whole).all(axis=1)]
    found = total.describe()
    assert found["count"] == [len(whole)]
    if not len(whole):
        assert found["min"] == [0.0] * 3
        return
    for name, expected in (
        ("min", whole.min(axis=0)),
        ("max", whole.max(axis=0)),
        ("mean", whole.mean(axis=0)),
        ("std", whole.std(axis=0)),
    ):
        np.testing.assert_allclose(found[name], expected, atol=1e-9)
    assert all(a <= b for a, b in zip(found["q10"], found["q90"], strict=True))


def test_of_an_episode() -> None:
    stats = episode_stats(np.arange(101.0))
    assert {name: stats[name].shape for name in STATS} == dict.fromkeys(STATS, (1,))
    assert stats["count"][0] == 101
    np.testing.assert_allclose([stats[q][0] for q in ("q01", "q10", "q50")], [1, 10, 50])
    clouds = np.random.default_rng(0).normal(size=(4, 20, 3))
    stats = episode_stats(clouds)
    np.testing.assert_allclose(stats["mean"], clouds.mean(axis=(0, 1)))
    assert stats["count"][0] == 4


def test_those_on_disk_are_those_of_the_frames(real: Path) -> None:
    dataset = open_dataset(real)
    totals = json.loads((real / "meta/stats.json").read_text())
    episodes = pq.read_table(real / "meta/episodes/chunk-000/file-000.parquet")
    for feature in FEATURES:
        values = to_array(dataset.read([feature.name])[feature.name]).astype(np.float64)
        expected = episode_stats(values)
        for name in ("min", "max", "mean", "std", "count"):
            np.testing.assert_allclose(totals[feature.name][name], expected[name], atol=1e-6)
        _, frames = dataset.episode(1)
        mine = episode_stats(to_array(frames[feature.name]))
        for name in STATS:
            stored = episodes[f"stats/{feature.name}/{name}"][1].as_py()
            np.testing.assert_allclose(stored, mine[name], atol=1e-9)
