"""Training of the surface network."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from keypush.learning.checkpoint import parameter_count, save_network
from keypush.learning.clouds import Sampler, surface_samplers
from keypush.learning.config import TrainingConfig
from keypush.learning.labels import make_labels
from keypush.learning.lightning_run import check_accelerator, fit, one_thread
from keypush.learning.metrics import evaluate
from keypush.learning.record import data_record, digest_of, training_record
from keypush.learning.rows import Rows, read_rows
from keypush.learning.scenes import SceneTable, scene_table
from keypush.learning.split import Split, split_rows
from keypush.learning.surface_module import SurfaceModule

WEIGHTS = "surface_keypoint.safetensors"


def train(data_dir: Path, out_dir: Path, config: TrainingConfig) -> dict[str, Any]:
    """Trains a network, or goes on where an interrupted run in `out_dir` stopped.

    The finished network is written to `out_dir/surface_keypoint.safetensors`.

    Args:
        data_dir: folder of a data set.
        out_dir: folder for weights, checkpoints and logs; made if missing.
        config: settings.

    Returns:
        Errors in m on episodes and objects that were not trained on; see `metrics.evaluate`.

    Raises:
        UserError: the configuration is out of range, the data is empty or incomplete, or
            `out_dir` holds a run with another configuration or other data.
    """
    config.validate()
    check_accelerator(config)
    rows = read_rows(data_dir, keep_failures=config.keep_failures)
    samplers = surface_samplers(rows.objects)
    scenes = scene_table(rows, make_labels(rows, config.label))
    split = split_rows(rows, torch.isfinite(scenes.label).all(dim=1).numpy(), config)
    digest = _digest(scenes)
    module = SurfaceModule(
        config, scenes.take(split.train), scenes.take(split.validation), samplers
    )
    identity = {**dataclasses.asdict(config), "kind": "surface_keypoint", "data": digest}
    fit(module, out_dir, identity, gradient_clip_val=config.max_gradient)
    with one_thread():
        metrics = _final_metrics(module, rows, scenes, split, samplers, config)
    parameters = parameter_count(module.network)
    taught = data_record(rows, digest, config.held_out_objects)
    record = training_record(parameters, taught, config, metrics)
    save_network(module.network, out_dir / WEIGHTS, record)
    return metrics


def _final_metrics(
    module: SurfaceModule,
    rows: Rows,
    scenes: SceneTable,
    split: Split,
    samplers: Sequence[Sampler],
    config: TrainingConfig,
) -> dict[str, Any]:
    """Errors on validation episodes, then on each held-out object."""
    network = module.surface
    metrics: dict[str, Any] = {
        "history": module.history,
        "validation": evaluate(network, scenes.take(split.validation), samplers, config),
        "held_out_objects": {},
    }
    names = np.array([name for name, _ in rows.objects])[rows.object_index]
    for name in config.held_out_objects:
        index = split.held_out[torch.from_numpy(names[split.held_out.numpy()] == name)]
        metrics["held_out_objects"][name] = evaluate(network, scenes.take(index), samplers, config)
    return metrics


def _digest(scenes: SceneTable) -> str:
    """A hash of what is trained on."""
    columns = (getattr(scenes, column.name) for column in dataclasses.fields(scenes))
    return digest_of(column.numpy() for column in columns)
