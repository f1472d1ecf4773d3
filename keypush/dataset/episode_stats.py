"""Statistics of the fields, as LeRobot defines and joins them.

Of every entry along a field's last axis: minimum, maximum, mean, standard deviation, quantiles,
and of the field the count of frames. Frames in which a field is NaN are left out; an episode in
which it always is counts 0 frames and has zeros. The quantiles of a whole data set are the
weighted means of those of its episodes, as LeRobot takes them.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Stats = dict[str, Array]

_QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
STATS = ("min", "max", "mean", "std", "count", *_QUANTILES)


def episode_stats(values: Array) -> Stats:
    """Returns the statistics of one field in one episode, (k,) each and the count (1,).

    Args:
        values: (n,), (n, k) or (n, ..., k).
    """
    count = len(values)
    flat = values.reshape(count, -1).astype(np.float64)
    width = values.shape[-1] if values.ndim > 1 else 1
    kept = flat[np.isfinite(flat).all(axis=1)]
    points = kept.reshape(-1, width)
    if not len(points):
        zeros = {name: np.zeros(width) for name in STATS}
        return {**zeros, "count": np.zeros(1, dtype=np.int64)}
    return {
        "min": points.min(axis=0),
        "max": points.max(axis=0),
        "mean": points.mean(axis=0),
        "std": points.std(axis=0),
        "count": np.array([len(kept)]),
        **dict(
            zip(_QUANTILES, np.quantile(points, list(_QUANTILES.values()), axis=0), strict=True)
        ),
    }


class TotalStats:
    """Joins the statistics of one field, episode after episode."""

    def __init__(self) -> None:
        self._count = 0
        self._stats: Stats = {}

    def add(self, stats: Stats) -> None:
        """Joins one episode's; see Chan, Golub, LeVeque (1979) for the variance."""
        count = int(stats["count"][0])
        if not self._count:
            self._count, self._stats = count, stats
            return
        if not count:
            return
        share = count / (self._count + count)
        old, joined = self._stats, {}
        for name in ("mean", *_QUANTILES):
            joined[name] = old[name] + share * (stats[name] - old[name])
        apart = share * (1 - share) * (stats["mean"] - old["mean"]) ** 2
        variance = (1 - share) * old["std"] ** 2 + share * stats["std"] ** 2 + apart
        self._count += count
        self._stats = {
            **joined,
            "min": np.minimum(old["min"], stats["min"]),
            "max": np.maximum(old["max"], stats["max"]),
            "std": np.sqrt(variance),
        }

    def describe(self) -> dict[str, list[float]]:
        """Returns the entry of `meta/stats.json`."""
        values = {name: self._stats[name].tolist() for name in STATS if name != "count"}
        return {**values, "count": [self._count]}
