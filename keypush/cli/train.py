"""`keypush train`: a keypoint network from collected episodes."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, ClassVar

import tyro

from keypush.cli.output import prepare_output_dir
from keypush.errors import UserError
from keypush.learning.config import TrainingConfig


@dataclass(kw_only=True)
class Train:
    """Train the keypoint network on a data set.

    Writes weights and their description to OUT; a stopped run goes on from its last epoch.
    """

    after_interrupt: ClassVar[str] = "finished epochs are kept; the same command goes on from them"

    data: Path
    """Folder of a data set that `keypush collect` wrote."""
    out: Path
    """Folder for the weights."""
    config: Annotated[TrainingConfig, tyro.conf.arg(name="")] = field(
        default_factory=TrainingConfig
    )
    """Settings of the training."""

    def run(self) -> None:
        """Runs the verb."""
        if not self.data.is_dir():
            raise UserError(
                f"--data {self.data}: no such folder; allowed: one of `keypush collect`"
            )
        self.config.validate()
        out = prepare_output_dir(self.out)
        from keypush.learning.train import WEIGHTS, train

        metrics = train(self.data, out, self.config)
        for name, value in metrics.items():
            print(f"{name}: {value}")
        print(f"written: {out / WEIGHTS}")
