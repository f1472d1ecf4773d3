"""What an ablation found: a record for every finished training, and `ablation.json` of them all."""

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from keypush.atomic_file import write_whole
from keypush.errors import UserError, one_line
from keypush.learning.ablation.settings import SETTINGS, SHAPES, Setting, Shape

FILE = "ablation.json"


@dataclass(frozen=True, kw_only=True)
class Epoch:
    """What was measured in and after an epoch."""

    learning_rate: float
    train_mse: float
    """Mean square of normalised coordinates over the epoch, with dropout."""
    validation_error: float
    """Mean distance on other episodes of the trained objects, m."""
    held_out_error: float
    """Mean distance on held-out objects, m."""
    held_out_mse: float
    """Mean square of normalised coordinates there."""


@dataclass(frozen=True, kw_only=True)
class Training:
    """A finished training of a head."""

    setting: Setting
    seed: int
    epochs: tuple[Epoch, ...]
    objects: Mapping[str, float]
    """Mean distance on each held-out object after the last epoch, m."""

    @property
    def held_out_error(self) -> float:
        """After the last epoch, m."""
        return self.epochs[-1].held_out_error


@dataclass(frozen=True, kw_only=True)
class Encoder:
    """A pretrained encoder: average precision of its contact patches, on new scenes."""

    shape: Shape
    trained_objects: Mapping[str, float]
    """By kind of scene."""
    held_out_objects: Mapping[str, float]
    """By kind of scene."""


@dataclass(frozen=True, kw_only=True)
class Ablation:
    """All trainings of an ablation: 16 settings times its seeds."""

    seeds: tuple[int, ...]
    encoders: tuple[Encoder, ...]
    trainings: tuple[Training, ...]
    """In the order of `SETTINGS`, those of a setting in the order of `seeds`."""
    provenance: Mapping[str, Any]
    """Data, settings, revision, command."""

    def of(self, setting: Setting) -> Sequence[Training]:
        """The trainings of a setting, one for every seed."""
        return [training for training in self.trainings if training.setting == setting]

    def errors(self, setting: Setting) -> list[float]:
        """The errors on held-out objects after the last epoch, m, in the order of `seeds`."""
        return [training.held_out_error for training in self.of(setting)]


def read_ablation(folder: Path) -> Ablation:
    """Reads what `keypush ablate` found.

    Args:
        folder: its output folder, or one with its `ablation.json`.

    Raises:
        UserError: the file is missing, damaged or lacks a training.
    """
    path = folder / FILE
    content = _read(path)
    try:
        ablation = Ablation(
            seeds=tuple(int(seed) for seed in content["seeds"]),
            encoders=tuple(_encoder(entry) for entry in content["encoders"]),
            trainings=tuple(_training(entry) for entry in content["trainings"]),
            provenance=dict(content["provenance"]),
        )
        wanted = [(setting, seed) for setting in SETTINGS for seed in ablation.seeds]
        if [(t.setting, t.seed) for t in ablation.trainings] != wanted or not wanted:
            raise ValueError("trainings are missing")
        if [encoder.shape for encoder in ablation.encoders] != list(SHAPES):
            raise ValueError("encoders are missing")
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise _damaged(path, error) from error
    return ablation


def write_ablation(ablation: Ablation, folder: Path) -> None:
    """Writes `ablation.json`.

    Raises:
        UserError: the folder cannot be written.
    """
    _write(folder / FILE, dataclasses.asdict(ablation))


def read_training(path: Path) -> Training | None:
    """Reads the record of a training; None when there is none.

    Raises:
        UserError: it is damaged.
    """
    if not path.exists():
        return None
    content = _read(path)
    try:
        return _training(content)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise _damaged(path, error) from error


def write_training(training: Training, path: Path) -> None:
    """Writes the record of a training, and its folder where it is missing.

    Raises:
        UserError: the folder cannot be written.
    """
    _write(path, dataclasses.asdict(training))


def _training(entry: Mapping[str, Any]) -> Training:
    setting = entry["setting"]
    training = Training(
        setting=Setting(
            shape=Shape(**setting["shape"]), heads=setting["heads"], use_com=setting["use_com"]
        ),
        seed=int(entry["seed"]),
        epochs=tuple(_epoch(epoch) for epoch in entry["epochs"]),
        objects={name: _finite(value) for name, value in entry["objects"].items()},
    )
    if training.setting not in SETTINGS or not training.epochs:
        raise ValueError(f"setting is {setting}, of {len(training.epochs)} epochs")
    return training


def _epoch(entry: Mapping[str, Any]) -> Epoch:
    return Epoch(**{name: _finite(value) for name, value in entry.items()})


def _encoder(entry: Mapping[str, Any]) -> Encoder:
    return Encoder(
        shape=Shape(**entry["shape"]),
        trained_objects={k: _finite(v) for k, v in entry["trained_objects"].items()},
        held_out_objects={k: _finite(v) for k, v in entry["held_out_objects"].items()},
    )


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{value!r} is no finite number")
    return float(value)


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(
            f"{path}: cannot be read: {error.strerror}; allowed: what `keypush ablate` wrote"
        ) from error
    except ValueError as error:
        raise _damaged(path, error) from error


def _write(path: Path, content: Mapping[str, Any]) -> None:
    write_whole(path, (json.dumps(content, indent=1) + "\n").encode())


def _damaged(path: Path, error: Exception) -> UserError:
    return UserError(
        f"{path}: is damaged: {one_line(error)}; allowed: what `keypush ablate` wrote; delete it "
        "and run the same command again"
    )
