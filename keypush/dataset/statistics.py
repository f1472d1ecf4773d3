"""What a data set holds, in numbers and as text."""

from collections import Counter
from typing import Any

import numpy as np
import pyarrow.types as types
from numpy.typing import NDArray

from keypush.dataset.arrays import to_array
from keypush.dataset.layout import EPISODE_COLUMNS
from keypush.dataset.read import DataSet

_BINS = 10
_WIDTH = 40
"""Of the longest bar of a histogram."""
_KEYS = ("seed", "episode")
"""Numbers of which a histogram would say nothing."""


def dataset_statistics(dataset: DataSet) -> dict[str, Any]:
    """Returns what a data set holds, ready for JSON; lengths in frames, other units SI.

    Raises:
        UserError: a file is damaged.
    """
    episodes = dataset.episodes
    success = to_array(episodes["success"])
    labelled = sum(
        int(np.isfinite(to_array(batch["keypoint"])).all(axis=1).sum())
        for batch in dataset.batches(["keypoint"])
    )
    size = sum(path.stat().st_size for path in dataset.folder.glob("*/**/*.parquet"))
    return {
        "episodes": len(episodes),
        "frames": dataset.frames,
        "frames_with_keypoint": labelled,
        "fps": dataset.fps,
        "bytes": size,
        "success": int(success.sum()),
        "settled_success": int(to_array(episodes["settled_success"]).sum()),
        "outcomes": dict(sorted(Counter(episodes["outcome"].to_pylist()).items())),
        "objects": _objects(dataset),
        "histograms": _histograms(dataset),
        "fields": {f.name: [f.dtype, list(f.shape)] for f in dataset.features},
    }


def tell_statistics(found: dict[str, Any]) -> list[str]:
    """Says in lines of text what `dataset_statistics` found."""
    episodes, frames = found["episodes"], found["frames"]
    size, labelled = found["bytes"] / 1e6, found["frames_with_keypoint"]
    success, settled = found["success"], found["settled_success"]
    lines = [
        f"{episodes} episodes of {len(found['objects'])} objects",
        f"{frames} frames, {found['fps']} per second; {size:.1f} MB",
        f"success: {success} ({success / episodes:.1%})",
        f"settled success: {settled} ({settled / episodes:.1%})",
        "outcomes: " + ", ".join(f"{name} {n}" for name, n in found["outcomes"].items()),
        f"frames with a keypoint: {labelled} ({labelled / frames:.1%})",
        "",
        f"{'object':<16}{'episodes':>9}{'success':>9}{'frames':>9}",
    ]
    lines += [
        f"{name:<16}{line['episodes']:>9}{line['success']:>9}{line['frames']:>9}"
        for name, line in found["objects"].items()
    ]
    for name, histogram in found["histograms"].items():
        lines += ["", f"{name}:", *_bars(histogram)]
    return lines


def _objects(dataset: DataSet) -> dict[str, dict[str, int]]:
    table = dataset.episodes.select(["object", "success", "length"])
    objects: dict[str, dict[str, int]] = {}
    for row in table.to_pylist():
        line = objects.setdefault(row["object"], {"episodes": 0, "success": 0, "frames": 0})
        line["episodes"] += 1
        line["success"] += row["success"]
        line["frames"] += row["length"]
    return objects


def _histograms(dataset: DataSet) -> dict[str, dict[str, list[float]]]:
    """Of the length, and of every number told of the episodes that differs between them."""
    numbered = {*EPISODE_COLUMNS.names, *_KEYS} - {"length"}
    histograms = {}
    for field in dataset.episodes.schema:
        kind = field.type
        if field.name in numbered or not (types.is_floating(kind) or types.is_integer(kind)):
            continue
        values = to_array(dataset.episodes[field.name])
        values = values[np.isfinite(values)]
        if len(np.unique(values)) > 1:
            histograms[field.name] = _histogram(values)
    return histograms


def _histogram(values: NDArray[Any]) -> dict[str, list[float]]:
    counts, edges = np.histogram(values, bins=_BINS)
    return {"edges": edges.tolist(), "counts": counts.tolist()}


def _bars(histogram: dict[str, list[float]]) -> list[str]:
    edges, counts = histogram["edges"], histogram["counts"]
    most = max(counts)
    bars = []
    for low, high, count in zip(edges[:-1], edges[1:], counts, strict=True):
        bar = "#" * round(_WIDTH * count / most)
        bars.append(f"{low:>10.4g} to {high:<10.4g}{int(count):>7} {bar}".rstrip())
    return bars
