"""`keypush ablate`: the thesis' ablation of encoder, head and centre of mass."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import tyro

from keypush.cli.data_option import check_data
from keypush.cli.output import prepare_output_dir
from keypush.cli.parallel_options import check_positive
from keypush.errors import UserError
from keypush.learning.ablation.config import (
    SEEDS,
    AblationConfig,
    AblationHead,
)
from keypush.learning.pretraining.config import PretrainConfig
from keypush.worker_environment import usable_cores


@dataclass(kw_only=True)
class Ablate:
    """Train the 16 settings of the thesis' tables 5.3 and 5.4 and write what they reach.

    Encoder layers 2 or 3, patches of 32 or 16 points, 8 or 16 heads of the cross-attention, each
    with and without the centre of mass; 4 of the 16 objects are held out. Writes OUT/ablation.md
    with its plots and OUT/ablation.json; a stopped run goes on. See docs/learning.md.
    """

    after_interrupt: ClassVar[str] = (
        "finished trainings and epochs are kept; the same command goes on from them"
    )

    data: Path
    """Folder of a data set that `keypush collect` wrote."""
    out: Path
    """Folder for the results."""
    seeds: tuple[int, ...] = SEEDS
    """One training of every setting for each; more may be asked for later."""
    held_out_objects: Annotated[tuple[str, ...], tyro.conf.arg(metavar="NAME")] = ()
    """Objects that nothing is trained on; by default the catalogue's 4 of the 16."""
    workers: int | None = None
    """Trainings that run at once; by default one per core. Results do not depend on it."""
    report: Path | None = None
    """A Markdown file to write the page to as well, its plots beside it."""
    preset: Literal["affordable", "thesis"] = "affordable"
    """Settings of the heads, as for `keypush train`, but always on cached tokens. Fields of --head
    that differ from their defaults go before; one at its default counts as not given."""
    head: AblationHead = field(default_factory=AblationHead)
    """Settings of every head."""
    pretraining: PretrainConfig = field(default_factory=PretrainConfig)
    """Settings of every encoder's pretraining."""

    def run(self) -> None:
        """Runs the verb."""
        config = self._config()
        out = prepare_output_dir(self.out)
        from keypush.rollout.folder_lock import hold_folder

        with hold_folder(out):
            from keypush.learning.ablation.report import summary, write_report
            from keypush.learning.ablation.run import run_ablation
            from keypush.rollout.progress import say

            workers = self.workers or usable_cores()
            ablation = run_ablation(self.data, out, config, workers, say)
            pages = [out / "ablation.md", *([self.report] if self.report else [])]
            for page in pages:
                write_report(ablation, page)
        for line in summary(ablation):
            print(line)
        print(f"written: {', '.join(map(str, pages))}")

    def _config(self) -> AblationConfig:
        from keypush.learning.imitation.presets import preset_config

        check_data(self.data)
        check_positive("workers", self.workers)
        if self.report is not None:
            if self.report.suffix != ".md":
                raise UserError(f"--report {self.report}: allowed: a file that ends in .md")
            prepare_output_dir(self.report.parent)
        return AblationConfig(
            seeds=self.seeds,
            held_out_objects=self.held_out_objects,
            # All settings of an encoder share its cache, with either preset.
            head=replace(preset_config(self.head, self.preset), cache=self.head.cache),
            pretraining=self.pretraining,
        )
