"""`keypush demo`: one episode, in plain words and as a page to watch."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from keypush.cli.options import Policy, ScenarioOptions, resolve_scenario
from keypush.cli.output import prepare_output_dir, save_scenario, write_output

if TYPE_CHECKING:
    from keypush.rollout.episode import EpisodeResult

_OUTCOMES = {
    "success": "reached the goal",
    "toppled": "toppled",
    "fell": "fell off the table",
    "timed_out": "did not reach the goal in time",
}


@dataclass(kw_only=True)
class Demo(ScenarioOptions):
    """Run one episode and record it.

    Prints the outcome and writes OUT/recording.html, a self-contained page that plays the
    episode in a browser, OUT/summary.json and OUT/scenario.yaml.
    """

    after_interrupt: ClassVar[str] = "nothing was recorded"

    object: str | None = None
    """Object to push, by its name in the catalogue."""
    policy: Policy | None = None
    """Who drives the tool: the learned keypoint, the expert, or the cloud's centroid."""
    out: Path = Path("out/demo")
    """Folder for the results."""

    def run(self) -> None:
        """Runs the verb."""
        scenario = resolve_scenario(self, object__name=self.object, policy=self.policy)
        out = prepare_output_dir(self.out)
        from keypush.rollout.episode import EpisodeRunner

        result = EpisodeRunner(scenario).run(episode=0)
        save_scenario(scenario, out)
        write_output(
            out / "summary.json", json.dumps(result.summary, indent=2, default=list) + "\n"
        )
        print(_tell(result))


def _tell(result: "EpisodeResult") -> str:
    summary = result.summary
    after = f"after {summary['steps']} policy steps ({result.seconds:.1f} s simulated)"
    return f"The {summary['object']} {_OUTCOMES[str(summary['outcome'])]} {after}."
