"""The ablation from a data set to its numbers; a stopped one goes on where it was."""

import pickle
import shutil
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from keypush.learning.ablation.checks import check_objects, claim_folder
from keypush.learning.ablation.config import AblationConfig
from keypush.learning.ablation.cost import encoding_seconds, head_seconds, pretraining_seconds
from keypush.learning.ablation.encoders import (
    EncoderTask,
    encoder_result,
    encoder_task,
    pretrain_encoder,
)
from keypush.learning.ablation.heads import KIND, HeadTask, record_path, train_setting
from keypush.learning.ablation.pool import run_all, worker_pool
from keypush.learning.ablation.results import Ablation, Training, read_training, write_ablation
from keypush.learning.ablation.settings import SETTINGS, SHAPES, Setting
from keypush.learning.checkpoint import load_network
from keypush.learning.imitation.token_cache import FOLDER, cache_bytes, cache_tokens, check_room
from keypush.learning.imitation.train import HeadData, head_data
from keypush.learning.lightning_run import one_thread
from keypush.learning.record import command_line, data_record, git_revision
from keypush.learning.rows import read_rows
from keypush.networks.contact_network import ContactNetwork

_BAR = "{percentage:3.0f}%|{bar}| [{elapsed}, {remaining} left{postfix}]"

Tell = Callable[[str], None]
Trainings = dict[tuple[Setting, int], Training]


@dataclass(frozen=True)
class _Plan:
    """What is to be done, and with what."""

    out_dir: Path
    config: AblationConfig
    workers: int
    tell: Tell
    data: HeadData
    encoders: Sequence[EncoderTask]
    done: Trainings

    def settings_of(self, encoder: EncoderTask) -> list[tuple[Setting, int]]:
        """What is left to train on an encoder."""
        return [
            (setting, seed)
            for setting in SETTINGS
            for seed in self.config.seeds
            if setting.shape == encoder.shape and (setting, seed) not in self.done
        ]

    def left(self) -> list[EncoderTask]:
        """The encoders on which something is left to train."""
        return [encoder for encoder in self.encoders if self.settings_of(encoder)]

    @property
    def cache(self) -> Path:
        """Folder of the tokens; one encoder's take the place of the one before."""
        return self.out_dir / FOLDER


def run_ablation(
    data_dir: Path, out_dir: Path, config: AblationConfig, workers: int, tell: Tell
) -> Ablation:
    """Pretrains the encoders and trains the heads that `out_dir` lacks.

    Leaves `ablation.json`. The numbers do not depend on `workers`, nor on how often it was stopped.

    Args:
        data_dir: folder of a data set.
        out_dir: folder for results; made if missing.
        config: settings.
        workers: trainings that run at once, >= 1.
        tell: is told what it costs, before.

    Raises:
        UserError: a setting is out of range, the data lacks an object, the disk lacks room,
            `out_dir` holds another ablation, or the system ended a process.
    """
    config.validate()
    rows = read_rows(data_dir, keep_failures=config.head.keep_failures)
    objects = check_objects(data_dir, rows, config)
    data = head_data(KIND, rows, data_dir, config.rows)
    claim_folder(out_dir, {**config.identity(), "data": data.digest})
    plan = _Plan(
        out_dir=out_dir,
        config=config,
        workers=workers,
        tell=tell,
        data=data,
        encoders=[encoder_task(shape, out_dir, objects, config) for shape in SHAPES],
        done=_finished(out_dir, config),
    )
    _work(plan)
    ablation = Ablation(
        seeds=config.seeds,
        encoders=tuple(encoder_result(encoder) for encoder in plan.encoders),
        trainings=tuple(plan.done[setting, seed] for setting in SETTINGS for seed in config.seeds),
        provenance={
            "data": {
                **data_record(rows, data.digest, config.held_out),
                "trained_rows": len(data.selection.train),
            },
            "settings": config.identity(),
            "git_revision": git_revision(),
            "command": command_line(),
        },
    )
    write_ablation(ablation, out_dir)
    return ablation


def _work(plan: _Plan) -> None:
    """Pretrains and trains what is left."""
    pending = [encoder for encoder in plan.encoders if not encoder.is_done]
    if not pending and not plan.left():
        return
    seconds = _announce(plan, pending)
    with (
        worker_pool(plan.workers) as pool,
        tqdm(total=seconds, bar_format=_BAR, disable=None, smoothing=0) as bar,
    ):
        for encoder, _ in run_all(pool, pretrain_encoder, pending):
            bar.set_postfix_str(f", encoder {encoder.shape.name} is done", refresh=False)
            bar.update(pretraining_seconds(encoder.config))
        for encoder in plan.left():
            _train_on(encoder, plan, pool, bar)
    shutil.rmtree(plan.cache, ignore_errors=True)


def _train_on(
    encoder: EncoderTask, plan: _Plan, pool: ProcessPoolExecutor, bar: "tqdm[Any]"
) -> None:
    network = load_network(encoder.weights, ContactNetwork)
    with one_thread():
        examples = plan.data.examples
        cache_tokens(plan.cache, examples, network.encoder, plan.config.rows, plan.tell)
    bar.update(encoding_seconds(len(examples), encoder.config.encoder))
    packed = pickle.dumps(plan.data)
    tasks = [
        HeadTask(
            setting=setting,
            seed=seed,
            out_dir=plan.out_dir,
            encoder=encoder.weights,
            cache=plan.cache,
            config=plan.config.of_head(setting, seed),
            data=packed,
        )
        for setting, seed in plan.settings_of(encoder)
    ]
    for task, training in run_all(pool, train_setting, tasks):
        plan.done[task.setting, task.seed] = training
        bar.set_postfix_str(
            f", {len(plan.done)} of {len(SETTINGS) * len(plan.config.seeds)} heads are done",
            refresh=False,
        )
        bar.update(_head_seconds(encoder, task.setting, plan))


def _announce(plan: _Plan, pending: Sequence[EncoderTask]) -> float:
    """Says what is left and what it costs; returns its seconds of one core."""
    left = plan.left()
    heads = sum(len(plan.settings_of(encoder)) for encoder in left)
    seconds = sum(pretraining_seconds(encoder.config) for encoder in pending)
    size = 0
    for encoder in left:
        seconds += encoding_seconds(len(plan.data.examples), encoder.config.encoder)
        seconds += sum(_head_seconds(encoder, s, plan) for s, _ in plan.settings_of(encoder))
        size = max(size, cache_bytes(len(plan.data.examples), encoder.config.encoder))
    if left:
        plan.cache.mkdir(exist_ok=True)
        check_room(plan.cache, size)
    name = "1 worker" if plan.workers == 1 else f"{plan.workers} workers"
    plan.tell(
        f"{len(pending)} encoders and {heads} heads to train: about {_duration(seconds)} of one "
        f"core, {_duration(seconds / plan.workers)} with {name} on cores of their own; at most "
        f"{size / 1e9:.2f} GB of tokens on disk at once"
    )
    return seconds


def _head_seconds(encoder: EncoderTask, setting: Setting, plan: _Plan) -> float:
    sizes, rows = encoder.config.encoder, len(plan.data.selection.train)
    return head_seconds(rows, sizes, setting.heads, plan.config.head)


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def _finished(out_dir: Path, config: AblationConfig) -> Trainings:
    found = {
        (setting, seed): read_training(record_path(out_dir, setting, seed))
        for setting in SETTINGS
        for seed in config.seeds
    }
    return {key: training for key, training in found.items() if training is not None}
