"""`keypush bench`: how fast and how true the simulation is."""

import json
import os
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import tyro

from keypush.cli.options import ScenarioOptions, resolve_scenario
from keypush.errors import UserError


@dataclass(kw_only=True)
class Bench(ScenarioOptions):
    """Measure the whole stack against its reference and against MuJoCo, with the expert."""

    after_interrupt: ClassVar[str] = "nothing was measured"

    what: tyro.conf.Positional[Literal["sim"]]
    """What to measure; sim: speed and final poses of the simulation, on one core."""
    json: bool = False
    """Print one JSON object instead of a table."""
    objects: Annotated[str, tyro.conf.arg(metavar="train|unseen|all|NAME,...")] = "all"
    """Objects to push."""
    episodes: Annotated[int, tyro.conf.arg(metavar="N")] = 5
    """Episodes per object."""

    def run(self) -> None:
        """Runs the verb."""
        if self.episodes < 1:
            raise UserError(f"--episodes is {self.episodes}; allowed: 1 or more")
        _use_one_thread()
        from rich.console import Console

        from keypush.bench.compare import measure_objects
        from keypush.bench.report import report_table, summarise_tracks
        from keypush.objects.catalogue import parse_object_list

        scenario = resolve_scenario(self, policy="expert")
        tracks = measure_objects(scenario, parse_object_list(self.objects), self.episodes)
        report = summarise_tracks(scenario, tracks)
        if self.json:
            print(json.dumps(report))
        else:
            Console().print(report_table(report))


def _use_one_thread() -> None:
    """NumPy reads these when it is imported, which is later than here."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
