"""`keypush evaluate`: success rates with their intervals."""

from dataclasses import dataclass
from typing import Annotated, Any

import tyro

from keypush.cli.options import OBJECTS, Policy, ScenarioOptions, resolve_scenario
from keypush.cli.output import EVALUATION, prepare_output_dir
from keypush.cli.parallel_options import ParallelOptions, make_job
from keypush.errors import UserError

Values = Annotated[tuple[float, ...], tyro.conf.arg(metavar="NUMBER...")]


@dataclass(kw_only=True)
class Evaluate(ScenarioOptions, ParallelOptions):
    """Run seeded episodes per object and report success rates with 95 % intervals.

    Prints a table and writes OUT/summary.json and OUT/records.parquet, one row per episode, beside
    all rows and the scenario. Seed n stands for the n-th seed that is kept for evaluation.
    """

    policy: Policy = None
    weights: str | None = None
    """Name of shipped weights, or path of a .safetensors file; by default those that ship under
    the policy's name."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "unseen"
    """Objects to push."""
    episodes: int = 50
    """Episodes per object and condition."""
    sizes: Values = ()
    """Values of object.size_ratio; every combination with the next two is a condition."""
    com_shifts: Values = ()
    """Values of variation.com_shift, m."""
    cloud_noise: Values = ()
    """Values of noise.cloud_deviation, m."""
    record_failures: int = 0
    """How many failed episodes of each object and condition to record as pages to watch."""

    def run(self) -> None:
        """Runs the verb."""
        from dataclasses import replace

        from keypush.evaluation.conditions import grid
        from keypush.evaluation.evaluate import evaluate, evaluation_report, write_report
        from keypush.policies import find_policy
        from keypush.seeding import evaluation_seed

        if self.record_failures < 0:
            raise UserError(f"--record-failures is {self.record_failures}; allowed: 0 or more")
        scenario = resolve_scenario(self, policy=self.policy, predictor__weights=self.weights)
        if self.weights is not None and find_policy(scenario.policy).weights_kind is None:
            raise UserError(
                f"--weights is {self.weights!r}, but policy {scenario.policy} has none; "
                "allowed: a policy that has learned, or no weights"
            )
        scenario = replace(scenario, seed=evaluation_seed(scenario.seed))
        values = {
            "sizes": self.sizes,
            "com-shifts": self.com_shifts,
            "cloud-noise": self.cloud_noise,
        }
        conditions = grid(scenario, values)
        job = make_job(scenario, self, option="episodes", episodes=self.episodes)
        jobs = [replace(job, scenario=condition) for condition in conditions]
        out = prepare_output_dir(self.out, holds=EVALUATION)
        records = evaluate(jobs, out, workers=self.workers, engine=self.engine)
        report = evaluation_report(scenario, jobs, records)
        path = write_report(report, out)
        _print_tables(report)
        for reason, number in report.get("reasons", {}).items():
            print(f"policy failed in {number} {'episode' if number == 1 else 'episodes'}: {reason}")
        print(f"written: {path}")
        if self.record_failures:
            from keypush.evaluation.failures import record_failures

            for page in record_failures(jobs, records, out, self.record_failures):
                print(f"recorded: {page}")


def _print_tables(report: dict[str, Any]) -> None:
    from rich.console import Console

    from keypush.evaluation.table import conditions_table, summary_table

    console = Console()
    title = f"{report['policy']}, scenario seed {report['seed']}"
    conditions = report["conditions"]
    for name, summary in conditions.items():
        console.print(summary_table(summary, title if len(conditions) == 1 else f"{title}, {name}"))
    if len(conditions) > 1:
        console.print(conditions_table(conditions))
