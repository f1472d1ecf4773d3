"""`keypush bench`: speed and truth of simulation and networks; what variation and training cost."""

import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import tyro

from keypush.cli.options import OBJECTS, ScenarioOptions, resolve_scenario
from keypush.errors import UserError
from keypush.worker_environment import ONE_THREAD

if TYPE_CHECKING:
    from rich.table import Table

    from keypush.scenario import Scenario


@dataclass(kw_only=True)
class Bench(ScenarioOptions):
    """Measure, on one core, the simulation with the expert, the cost of variation, or networks."""

    after_interrupt: ClassVar[str] = "nothing was measured"

    what: tyro.conf.Positional[Literal["sim", "policies", "variation", "predictor", "train"]]
    """sim: speed and final poses of the whole stack, beside its reference and MuJoCo. policies: CPU
    time of an episode with every policy, and the shares of physics, network and Python. variation:
    time per reset when the object's mass, friction or size differs in every episode. predictor:
    time of an answer of every learned policy's network, and its distance from PyTorch's. train: how
    fast the thesis' head trains on cached tokens, beside the way one would write it down; on
    pretended data, so that no other option but --json matters."""
    json: bool = False
    """Print one JSON object instead of a table."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "all"
    """Objects to push."""
    episodes: Annotated[int, tyro.conf.arg(metavar="N")] = 5
    """Episodes per object; for predictor, twice as many scenes."""

    def run(self) -> None:
        """Runs the verb."""
        if self.episodes < 1:
            raise UserError(f"--episodes is {self.episodes}; allowed: 1 or more")
        _use_one_thread()
        from rich.console import Console

        from keypush.objects.library import parse_object_list

        scenario = resolve_scenario(self, policy="expert")
        objects = parse_object_list(self.objects)
        if self.what == "train":
            report, table = _measure_training()
        else:
            measure = {
                "sim": _measure_simulation,
                "policies": _measure_policies,
                "variation": _measure_variation,
                "predictor": _measure_predictors,
            }[self.what]
            report, table = measure(scenario, objects, self.episodes)
        if self.json:
            print(json.dumps(report))
        else:
            Console().print(table)


def _measure_simulation(
    scenario: "Scenario", objects: list[str], episodes: int
) -> tuple[dict[str, Any], "Table"]:
    from keypush.bench.compare import measure_objects
    from keypush.bench.report import report_table, summarise_tracks

    report = summarise_tracks(scenario, measure_objects(scenario, objects, episodes))
    return report, report_table(report)


def _measure_policies(
    scenario: "Scenario", objects: list[str], episodes: int
) -> tuple[dict[str, Any], "Table"]:
    from keypush.bench.policy_time import measure_policies, policies_table, summarise_policies

    policies = measure_policies(scenario, objects, episodes)
    report = summarise_policies(policies, len(objects) * episodes)
    return report, policies_table(report)


def _measure_variation(
    scenario: "Scenario", objects: list[str], episodes: int
) -> tuple[dict[str, Any], "Table"]:
    from keypush.bench.variation_cost import measure_resets, resets_table, summarise_resets

    report = summarise_resets(scenario, measure_resets(scenario, objects, episodes))
    return report, resets_table(report)


def _measure_training() -> tuple[dict[str, Any], "Table"]:
    from keypush.bench.train_speed import measure_training, training_table

    report = measure_training(seconds=4.0)
    return report, training_table(report)


def _measure_predictors(
    scenario: "Scenario", objects: list[str], episodes: int
) -> tuple[dict[str, Any], "Table"]:
    from keypush.bench.predictor import (
        measure_predictors,
        predictors_table,
        summarise_predictors,
    )

    scenes = 2 * episodes
    networks = measure_predictors(scenario, objects, scenes)
    report = summarise_predictors(scenario, networks, len(objects) * scenes)
    return report, predictors_table(report)


def _use_one_thread() -> None:
    """NumPy reads these when it is imported, which is later than here."""
    os.environ.update(ONE_THREAD)
