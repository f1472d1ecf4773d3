"""`keypush pretrain`: the encoder, from contacts of gripper and objects."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, ClassVar

import tyro

from keypush.cli.options import OBJECTS
from keypush.cli.output import prepare_output_dir
from keypush.learning.pretraining.config import PretrainConfig
from keypush.rollout.folder_lock import hold_folder


@dataclass(kw_only=True)
class Pretrain:
    """Pretrain the encoder: which patches of a cloud touch the gripper?

    Draws its scenes itself. Writes OUT/contact.safetensors, its card, checkpoints and logs; a
    stopped run goes on from its last epoch. See docs/learning.md.
    """

    after_interrupt: ClassVar[str] = "finished epochs are kept; the same command goes on from them"

    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "train"
    """Objects to train on."""
    measure_on: Annotated[tuple[str, ...], tyro.conf.arg(metavar=OBJECTS)] = ("id", "ood")
    """More lists of objects that the finished network is measured on."""
    out: Path
    """Folder for the weights."""
    training: Annotated[PretrainConfig, tyro.conf.arg(name="")] = field(
        default_factory=PretrainConfig
    )
    """Settings."""

    def run(self) -> None:
        """Runs the verb."""
        self.training.validate()
        out = prepare_output_dir(self.out)
        from keypush.learning.pretraining.train import WEIGHTS, pretrain

        with hold_folder(out):
            scored = pretrain(self.objects, self.measure_on, out, self.training)
        for name, kinds in scored.items():
            for kind, scores in kinds.items():
                print(
                    f"{name}, {kind.replace('_', ' ')}: average precision "
                    f"{scores['average_precision']:.3f}, F1 {scores['f1']:.3f}, calibration error "
                    f"{scores['calibration_error']:.4f}"
                )
        print(f"written: {out / WEIGHTS}")
