"""`keypush diagram`: the systems, their ports and wires as a picture."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from keypush.cli.options import Policy, ScenarioOptions, resolve_scenario
from keypush.cli.output import write_output


@dataclass(kw_only=True)
class Diagram(ScenarioOptions):
    """Draw the Drake diagram of an episode as SVG."""

    after_interrupt: ClassVar[str] = "nothing was written"

    policy: Policy = None
    out: Path = Path("diagram.svg")
    """File to write."""

    def run(self) -> None:
        """Runs the verb."""
        from diagrams.svg import diagram_svg
        from keypush.rollout.episode import EpisodeRunner

        runner = EpisodeRunner(resolve_scenario(self, policy=self.policy))
        write_output(self.out, diagram_svg(runner.push.diagram))
        print(f"written: {self.out}")
