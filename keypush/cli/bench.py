"""`keypush bench`: how fast and how true the simulation is."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import tyro

from keypush.errors import UserError


@dataclass(kw_only=True)
class Bench:
    """Measure the whole stack against its reference and against MuJoCo."""

    after_interrupt: ClassVar[str] = "nothing was measured"

    what: tyro.conf.Positional[Literal["sim"]]
    """What to measure; sim: speed and final poses of the simulation, on one core."""
    json: bool = False
    """Print one JSON object instead of a table."""
    episodes: Annotated[int, tyro.conf.arg(metavar="N")] = 3
    """Episodes per object."""

    def run(self) -> None:
        """Runs the verb."""
        if self.episodes < 1:
            raise UserError(f"--episodes is {self.episodes}; allowed: 1 or more")
