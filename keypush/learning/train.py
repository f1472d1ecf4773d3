"""Training of the keypoint network."""

import dataclasses
import hashlib
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import torch
from tqdm import tqdm

from keypush.learning.checkpoint import parameter_count, save_network
from keypush.learning.clouds import Sampler, draw_clouds, surface_samplers
from keypush.learning.config import TrainingConfig
from keypush.learning.labels import make_labels
from keypush.learning.metrics import evaluate
from keypush.learning.rows import Rows, read_rows
from keypush.learning.scenes import SceneTable, augment, scene_table, to_network, with_clouds
from keypush.learning.split import Split, split_rows
from keypush.learning.training_state import TrainingState, load_state, save_state
from keypush.seeding import make_generator

WEIGHTS = "keypoint.safetensors"
STATE = "training.pt"


def train(data_dir: Path, out_dir: Path, config: TrainingConfig) -> dict[str, Any]:
    """Trains a network, or goes on where an interrupted run in `out_dir` stopped.

    After every epoch the state is saved whole, so a run may be stopped at any time; stopped and
    resumed it ends with the same weights as in one go. The finished network is written to
    `out_dir/keypoint.safetensors`.

    Args:
        data_dir: folder of a data set.
        out_dir: folder for weights and state; made if missing.

    Returns:
        Errors in m on episodes and objects that were not trained on; see `metrics.evaluate`.

    Raises:
        UserError: the configuration is out of range, the data is empty or incomplete, or
            `out_dir` holds a run with another configuration.
    """
    config.validate()
    rows = read_rows(data_dir, keep_failures=config.keep_failures)
    scenes = scene_table(rows, make_labels(rows, config.label))
    split = split_rows(rows, scenes, config)
    samplers = surface_samplers(rows.objects)
    with one_thread():
        state = load_state(out_dir / STATE, config) or TrainingState.new(config)
        for epoch in range(state.epoch, config.epochs):
            loss = train_epoch(state, scenes.take(split.train), samplers, config)
            validation = evaluate(state.network, scenes.take(split.validation), samplers, config)
            state.history.append({"loss": loss, **validation})
            state.epoch = epoch + 1
            save_state(state, out_dir / STATE, config)
        metrics = _final_metrics(state, rows, scenes, split, samplers, config)
    record = {
        "parameters": parameter_count(state.network),
        "git_revision": _git_revision(),
        "data": {
            "rows": len(rows),
            "objects": sorted({name for name, _ in rows.objects}),
            "sha256": _digest(scenes),
            "seeds": rows.seeds,
        },
        "training": dataclasses.asdict(config),
        "metrics": metrics,
    }
    save_network(state.network, out_dir / WEIGHTS, record)
    return metrics


def train_epoch(
    state: TrainingState, scenes: SceneTable, samplers: Sequence[Sampler], config: TrainingConfig
) -> float:
    """Trains one epoch, with draws that depend on seed and epoch alone; returns the mean loss."""
    rng = make_generator(config.seed, state.epoch, "training")
    bank = draw_clouds(samplers, config, rng)
    generator = torch.Generator().manual_seed(int(rng.integers(2**62)))
    order = torch.from_numpy(rng.permutation(len(scenes))[: config.rows_per_epoch])
    batches = torch.split(order, config.batch)
    progress = tqdm(batches, f"epoch {state.epoch + 1}/{config.epochs}", leave=False, disable=None)
    state.network.train()
    total = 0.0
    for i, index in enumerate(progress):
        batch = with_clouds(scenes.take(index), bank, generator)
        if config.augment:
            batch = augment(batch, generator)
        scene, label, _ = to_network(batch, use_com=config.network.use_com)
        done = (state.epoch + i / len(batches)) / config.epochs
        for group in state.optimizer.param_groups:
            group["lr"] = config.learning_rate * rate(done)
        loss = (state.network(scene) - label).norm(dim=1).mean()
        state.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(state.network.parameters(), config.max_gradient)
        state.optimizer.step()
        total += float(loss.detach()) * len(index)
        progress.set_postfix(loss=f"{float(loss.detach()):.3f}", refresh=False)
    state.network.eval()
    return total / len(order)


def rate(done: float) -> float:
    """The share of the peak learning rate when a share `done` of the steps is behind."""
    warm_up = 0.05
    if done < warm_up:
        return (done + 0.001) / (warm_up + 0.001)
    return float(0.5 + 0.5 * np.cos(np.pi * (done - warm_up) / (1 - warm_up)))


def _final_metrics(
    state: TrainingState,
    rows: Rows,
    scenes: SceneTable,
    split: Split,
    samplers: Sequence[Sampler],
    config: TrainingConfig,
) -> dict[str, Any]:
    """Errors on validation episodes, then on each held-out object."""
    network = state.network
    metrics: dict[str, Any] = {
        "history": state.history,
        "validation": evaluate(network, scenes.take(split.validation), samplers, config),
        "held_out_objects": {},
    }
    names = np.array([name for name, _ in rows.objects])[rows.object_index]
    for name in config.held_out_objects:
        index = split.held_out[torch.from_numpy(names[split.held_out.numpy()] == name)]
        metrics["held_out_objects"][name] = evaluate(network, scenes.take(index), samplers, config)
    return metrics


@contextmanager
def one_thread() -> Iterator[None]:
    """Runs torch on one thread, so that sums are added in the same order on every machine."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


def _digest(scenes: SceneTable) -> str:
    """A hash of what is trained on."""
    digest = hashlib.sha256()
    for column in (scenes.object_index, scenes.p_CO, scenes.R_CO, scenes.goal, scenes.label):
        digest.update(column.numpy().tobytes())
    return digest.hexdigest()


def _git_revision() -> str:
    """The revision of the code, or "unknown" outside a checkout."""
    try:
        command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()
