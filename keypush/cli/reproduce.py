"""`keypush reproduce`: the thesis' tables, run anew."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from keypush.cli.output import REPRODUCTION, prepare_output_dir
from keypush.cli.parallel_options import WorkerOptions, check_positive


@dataclass(kw_only=True)
class Reproduce(WorkerOptions):
    """Run the thesis' policies and ours under its conditions, and write its tables anew.

    Writes OUT/tables.md, OUT/summary.json and OUT/speed.md, with OUT/records.parquet of all
    episodes and the records of OUT/POLICY/CONDITION; a stopped run goes on. See docs/evaluation.md.
    """

    scale: Literal["quick", "full"]
    """quick: a sample of objects, sizes and episodes, 7 to 9 minutes on two cores. full: 32
    objects in five sizes, 50 episodes of each, six hours on two cores."""
    policies: Annotated[tuple[str, ...], tyro.conf.arg(metavar="POLICY...")] = ()
    """Policies to run; by default all eight."""
    ablation: Path | None = None
    """Folder of `keypush ablate`, for the thesis' tables of its ablation."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.reproduction.plan import PLANS, REPRODUCED, check_policies
        from keypush.reproduction.report import SPEED_FILE, TABLES_FILE
        from keypush.reproduction.reproduce import reproduce

        check_positive("workers", self.workers)
        policies = self.policies or REPRODUCED
        check_policies(policies)
        out = prepare_output_dir(self.out, holds=REPRODUCTION)
        reproduce(
            PLANS[self.scale],
            policies,
            out,
            workers=self.workers,
            engine=self.engine,
            ablation=self._ablation(out),
        )
        tables, speed = out / TABLES_FILE, out / SPEED_FILE
        for path in (tables, speed):
            print(path.read_text(encoding="utf-8"))
        print(f"written: {tables} and {speed}")

    def _ablation(self, out: Path) -> str | None:
        """Writes the page of the ablation; before anything runs, since its folder may be wrong."""
        if self.ablation is None:
            return None
        from keypush.reproduction.ablation import write_ablation_page

        return write_ablation_page(self.ablation, out)
