"""`keypush collect`: expert episodes as Parquet rows."""

from dataclasses import dataclass
from typing import Annotated

import tyro

from keypush.cli.options import OBJECTS, ScenarioOptions, resolve_scenario
from keypush.cli.parallel_options import ParallelOptions, run_episodes


@dataclass(kw_only=True)
class Collect(ScenarioOptions, ParallelOptions):
    """Run the expert and store one row per policy step, as Parquet.

    OUT/rows has the rows, OUT/episodes one line per episode, OUT/scenario.yaml the scenario.
    """

    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "train"
    """Objects to push."""
    episodes: int = 100
    """Episodes per object."""

    def run(self) -> None:
        """Runs the verb."""
        scenario = resolve_scenario(self, policy="expert")
        store = run_episodes(scenario, self)
        summaries = store.read_summaries()
        successes = sum(bool(summary["success"]) for summary in summaries)
        steps = sum(int(summary["steps"]) for summary in summaries)
        print(
            f"{len(summaries)} episodes, {steps} rows in {self.out}; "
            f"the expert succeeded in {successes / len(summaries):.1%}"
        )
