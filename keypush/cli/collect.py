"""`keypush collect`: a data set of expert episodes."""

from dataclasses import dataclass
from typing import Annotated, Literal

import tyro

from keypush.cli.options import OBJECTS, ScenarioOptions, resolve_scenario
from keypush.cli.output import prepare_output_dir
from keypush.cli.parallel_options import ParallelOptions, make_job
from keypush.errors import UserError


@dataclass(kw_only=True)
class Collect(ScenarioOptions, ParallelOptions):
    """Run the expert and make a data set of its episodes.

    While it runs, finished blocks of episodes lie in OUT/collecting; after a stop the same
    command goes on from them. In the end OUT/data and OUT/meta are the data set.
    """

    expert: Literal["tuned", "thesis"] = "tuned"
    """Settings of the expert. Fields of planner in the scenario that differ from their defaults go
    before; one at its default counts as not given."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "train"
    """Objects to push."""
    episodes_per_object: int = 100
    """Episodes of each object."""

    def run(self) -> None:
        """Runs the verb."""
        from keypush.planning.presets import expert_scenario
        from keypush.rollout.collection import collect_dataset

        scenario = expert_scenario(resolve_scenario(self, policy="expert"), self.expert)
        _check_seed(scenario.seed)
        job = make_job(
            scenario, self, option="episodes-per-object", episodes=self.episodes_per_object
        )
        out = prepare_output_dir(self.out)
        summaries = collect_dataset(job, out, workers=self.workers, engine=self.engine)
        if summaries is None:
            print(f"{out} is complete: {job.total} episodes; nothing to do")
            return
        successes = sum(bool(summary["success"]) for summary in summaries)
        steps = sum(int(summary["steps"]) for summary in summaries)
        print(
            f"{len(summaries)} episodes, {steps} steps in {out}; "
            f"the expert succeeded in {successes / len(summaries):.1%}"
        )


def _check_seed(seed: int) -> None:
    from keypush.seeding import EVALUATION_SEEDS

    if seed >= EVALUATION_SEEDS:
        raise UserError(
            f"seed is {seed}; allowed for data: 0 to {EVALUATION_SEEDS - 1}, "
            "since those from there on are for evaluation"
        )
