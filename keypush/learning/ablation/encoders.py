"""One pretrained encoder for every shape."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from keypush.learning.ablation.config import AblationConfig
from keypush.learning.ablation.results import Encoder
from keypush.learning.ablation.settings import Shape
from keypush.learning.card import read_card
from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.train import WEIGHTS, pretrain


@dataclass(frozen=True, kw_only=True)
class EncoderTask:
    """A pretraining.

    Attributes:
        shape: of the encoder.
        folder: for weights, checkpoints and logs.
        objects: of the data, held-out ones too.
        config: settings, which say what is held out.
    """

    shape: Shape
    folder: Path
    objects: tuple[str, ...]
    config: PretrainConfig

    @property
    def weights(self) -> Path:
        """The finished network."""
        return self.folder / WEIGHTS

    @property
    def is_done(self) -> bool:
        """Whether it is there; its card is written last."""
        return self.weights.with_suffix(".json").exists()


def encoder_task(
    shape: Shape, out_dir: Path, objects: tuple[str, ...], config: AblationConfig
) -> EncoderTask:
    """Returns the pretraining of a shape."""
    return EncoderTask(
        shape=shape,
        folder=out_dir / "encoders" / shape.name,
        objects=objects,
        config=config.of_encoder(shape),
    )


def pretrain_encoder(task: EncoderTask) -> None:
    """Pretrains, from where an interrupted pretraining was stopped.

    Raises:
        UserError: see `pretrain`.
    """
    pretrain(",".join(task.objects), (), task.folder, task.config)


def encoder_result(task: EncoderTask) -> Encoder:
    """Reads from its card how well an encoder tells patches in contact.

    Raises:
        UserError: the card cannot be read.
    """
    metrics: Any = read_card(task.weights)["metrics"]
    held_out = task.config.held_out_objects
    others = held_out[0] if len(held_out) == 1 else "held_out_objects"

    def precision(label: str) -> dict[str, float]:
        return {kind: scores["average_precision"] for kind, scores in metrics[label].items()}

    return Encoder(
        shape=task.shape, trained_objects=precision("train"), held_out_objects=precision(others)
    )
