"""How near a keypoint network comes to the label with more and more rows: `docs/learning.md`.

    scripts/uv.sh run scripts/study_data_size.py DATA ENCODER MEASURED OUT [ROWS_PER_OBJECT...]

Trains the thesis' network with the centre of mass on so many rows of every object of DATA (0: all)
and measures it on the episodes of MEASURED as `offline_errors.py` does. Every training takes about
as many optimiser steps as the usual passes over all rows, so that what they are taken on differs
and few rows are not at a disadvantage. What is trained stays in OUT and is not trained again;
`errors.json` and `errors.png` lie there in the end.
"""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import tyro
from as_command import as_command
from matplotlib.figure import Figure
from offline_errors import measure

from keypush.dataset.read import open_dataset
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.train import train_imitation

ROWS = (625, 2_500, 10_000, 40_000, 0)
"""With 16 objects: 10 000 rows, four times as many, and so on, and all."""
PASSES = 5
"""Over all rows: a training of every size takes as many steps."""
_SPLITS = {"train": "objects trained on", "id": "like them", "ood": "unlike them"}


def settings(data: Path, rows: int) -> ImitationConfig:
    """Returns those of a training: fewer rows are seen more often."""
    usual = ImitationConfig(rows_per_object=rows)
    factor = PASSES / usual.epochs
    if rows:
        dataset = open_dataset(data)
        every = (1 - usual.validation_share) * dataset.frames
        factor *= every / (rows * len(set(dataset.episodes["object"].to_pylist())))
    return replace(
        usual,
        epochs=round(usual.epochs * factor),
        halve_every=round(usual.halve_every * factor),
    )


def train(data: Path, encoder: str, out: Path, rows: int) -> Path:
    """Trains on so many rows of every object, unless that is done; returns the weights."""
    weights = out / "keypoint.safetensors"
    if not weights.exists():
        print(f"{rows or 'all'} rows of every object", flush=True)
        train_imitation("keypoint", data, out, encoder, settings(data, rows), print)
        shutil.rmtree(out / "cache")
    return weights


def errors_of(weights: Path, measured: Path) -> dict[str, Any]:
    """Returns the number of rows that weights were trained on, and their errors."""
    card = json.loads(weights.with_suffix(".json").read_text(encoding="utf-8"))
    found = measure(measured, [f"keypoint={weights}"])[f"keypoint={weights}"]
    return {"rows": card["data"]["trained_rows"], **found}


def draw(points: list[dict[str, Any]], path: Path) -> None:
    """Draws mean errors over the number of rows."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    rows = [point["rows"] for point in points]
    for (split, told), marker in zip(_SPLITS.items(), "os^", strict=True):
        axes.plot(rows, [p[split]["error_cm"] for p in points], marker=marker, label=told)
    axes.set(
        xscale="log", xlabel="rows trained on", ylabel="mean distance to the label, cm", ylim=0
    )
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=110)


def main(
    data: Path,
    encoder: str,
    measured: Path,
    out: Path,
    rows_per_object: tyro.conf.Positional[tuple[int, ...]] = ROWS,
) -> None:
    """Trains what is missing, measures, and draws.

    Args:
        data: the data set that is learnt from.
        encoder: weights of the pretrained encoder, or "auto".
        measured: the data set on which errors are measured.
        out: the folder.
        rows_per_object: one training each; 0 takes all rows.
    """
    open_dataset(measured)
    points = []
    for rows in rows_per_object:
        weights = train(data, encoder, out / f"rows_{rows}", rows)
        points.append(errors_of(weights, measured))
        (out / "errors.json").write_text(json.dumps(points, indent=1) + "\n", encoding="utf-8")
    draw(points, out / "errors.png")


if __name__ == "__main__":
    as_command(main)
