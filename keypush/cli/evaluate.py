"""`keypush evaluate`: success rates with their intervals."""

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import tyro

from keypush.cli.options import OBJECTS, Policy, ScenarioOptions, resolve_scenario
from keypush.cli.output import prepare_output_dir
from keypush.cli.parallel_options import ParallelOptions, make_job

if TYPE_CHECKING:
    from keypush.evaluation.summary import Summary
    from keypush.scenario import Scenario


@dataclass(kw_only=True)
class Evaluate(ScenarioOptions, ParallelOptions):
    """Run seeded episodes per object and report success rates with 95 % intervals.

    Prints a table and writes OUT/summary.json, beside all rows and the scenario.
    """

    policy: Policy = None
    weights: str | None = None
    """Name of shipped weights, or path of a .safetensors file; by default those that ship under
    the policy's name."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "unseen"
    """Objects to push."""
    episodes: int = 50
    """Episodes per object."""

    def run(self) -> None:
        """Runs the verb."""
        from rich.console import Console

        from keypush.evaluation.summary import summarise
        from keypush.evaluation.table import summary_table
        from keypush.rollout.parallel import run_job

        scenario = resolve_scenario(self, policy=self.policy, predictor__weights=self.weights)
        job = make_job(scenario, self, option="episodes", episodes=self.episodes)
        out = prepare_output_dir(self.out)
        store = run_job(job, out, workers=self.workers, engine=self.engine)
        summary = summarise(store.read_summaries())
        path = self.out / "summary.json"
        path.write_text(_report(scenario, summary), encoding="utf-8")
        Console().print(summary_table(summary, f"{scenario.policy}, seed {scenario.seed}"))
        print(f"written: {path}")


def _report(scenario: "Scenario", summary: "Summary") -> str:
    import yaml

    from keypush.scenario import dump_scenario

    report = {
        "policy": scenario.policy,
        "seed": scenario.seed,
        **summary,
        "scenario": yaml.safe_load(dump_scenario(scenario)),
    }
    return json.dumps(report, indent=2) + "\n"
