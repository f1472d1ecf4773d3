"""`keypush bench`: how fast and how true the simulation is, and what variation costs."""

import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import tyro

from keypush.cli.options import OBJECTS, ScenarioOptions, resolve_scenario
from keypush.errors import UserError

if TYPE_CHECKING:
    from rich.table import Table

    from keypush.scenario import Scenario


@dataclass(kw_only=True)
class Bench(ScenarioOptions):
    """Measure, on one core and with the expert, the simulation or the cost of variation."""

    after_interrupt: ClassVar[str] = "nothing was measured"

    what: tyro.conf.Positional[Literal["sim", "variation"]]
    """sim: speed and final poses of the whole stack, beside its reference and MuJoCo. variation:
    time per reset when the object's mass, friction or size differs in every episode."""
    json: bool = False
    """Print one JSON object instead of a table."""
    objects: Annotated[str, tyro.conf.arg(metavar=OBJECTS)] = "all"
    """Objects to push."""
    episodes: Annotated[int, tyro.conf.arg(metavar="N")] = 5
    """Episodes per object."""

    def run(self) -> None:
        """Runs the verb."""
        if self.episodes < 1:
            raise UserError(f"--episodes is {self.episodes}; allowed: 1 or more")
        _use_one_thread()
        from rich.console import Console

        from keypush.objects.library import parse_object_list

        scenario = resolve_scenario(self, policy="expert")
        measure = {"sim": _measure_simulation, "variation": _measure_variation}[self.what]
        report, table = measure(scenario, parse_object_list(self.objects), self.episodes)
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


def _measure_variation(
    scenario: "Scenario", objects: list[str], episodes: int
) -> tuple[dict[str, Any], "Table"]:
    from keypush.bench.variation_cost import measure_resets, resets_table, summarise_resets

    report = summarise_resets(scenario, measure_resets(scenario, objects, episodes))
    return report, resets_table(report)


def _use_one_thread() -> None:
    """NumPy reads these when it is imported, which is later than here."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
