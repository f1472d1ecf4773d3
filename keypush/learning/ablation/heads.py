"""One training of a head, on a token cache that others read as well."""

import pickle
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from keypush.learning.ablation.results import Epoch, Training, write_training
from keypush.learning.ablation.settings import Setting
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.token_cache import open_cache
from keypush.learning.imitation.train import HeadData, make_network, train_head
from keypush.learning.lightning_run import CHECKPOINTS
from keypush.learning.tensors import encoder_record

KIND = "keypoint"


@dataclass(frozen=True, kw_only=True)
class HeadTask:
    """A training.

    Attributes:
        setting: what is trained.
        seed: of its first weights, order and dropout.
        out_dir: of the ablation.
        encoder: weights.
        cache: folder with the tokens that it made of the examples.
        config: settings.
        data: a pickled `HeadData` with the centre of mass; not as it is, because torch would
            send its tensors through shared memory, of which containers have little.
    """

    setting: Setting
    seed: int
    out_dir: Path
    encoder: Path
    cache: Path
    config: ImitationConfig
    data: bytes

    @property
    def record(self) -> Path:
        """Of the finished training."""
        return record_path(self.out_dir, self.setting, self.seed)

    @property
    def folder(self) -> Path:
        """For checkpoints and logs."""
        return self.out_dir / "heads" / self.record.stem


def record_path(out_dir: Path, setting: Setting, seed: int) -> Path:
    """Where the record of a finished training lies."""
    return out_dir / "records" / f"{setting.name}_seed{seed}.json"


def train_setting(task: HeadTask) -> Training:
    """Trains a head, from where an interrupted training was stopped, and leaves its record.

    Raises:
        UserError: see `train_head`.
    """
    data: HeadData = pickle.loads(task.data)
    if not task.setting.use_com:
        data = replace(data, examples=data.examples.without_com())
    network = make_network(KIND, task.encoder, task.config)
    tokens = open_cache(task.cache, len(data.examples), network.config.encoder)
    identity = {"kind": KIND, "encoder": encoder_record(task.encoder)["sha256"]}
    metrics = train_head(network, data, tokens, task.folder, task.config, identity)
    training = Training(
        setting=task.setting,
        seed=task.seed,
        epochs=tuple(
            _epoch(entry, task.config.rate_after(number))
            for number, entry in enumerate(metrics["history"])
        ),
        objects={name: each["error_mean"] for name, each in metrics["held_out_objects"].items()},
    )
    write_training(training, task.record)
    shutil.rmtree(task.folder / CHECKPOINTS)
    return training


def _epoch(entry: Mapping[str, Any], learning_rate: float) -> Epoch:
    return Epoch(
        learning_rate=learning_rate,
        train_mse=entry["loss"],
        validation_error=entry["error_mean"],
        held_out_error=entry["held_out_error_mean"],
        held_out_mse=entry["held_out_mse"],
    )
