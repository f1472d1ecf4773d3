"""`keypush demo`: one episode, in plain words and as a page to watch."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from keypush.cli.options import Policy, ScenarioOptions, resolve_scenario
from keypush.cli.output import DEMO, prepare_output_dir, save_scenario, write_output


@dataclass(kw_only=True)
class Demo(ScenarioOptions):
    """Run one episode and record it.

    Prints the outcome and writes OUT/recording.html, a self-contained page that plays the
    episode in a browser, OUT/summary.json and OUT/scenario.yaml.
    """

    after_interrupt: ClassVar[str] = "nothing was recorded"

    object: str | None = None
    """Object to push, by its name: a built-in one or one that was added."""
    policy: Policy = None
    out: Path = Path("out/demo")
    """Folder for the results."""

    def run(self) -> None:
        """Runs the verb."""
        scenario = resolve_scenario(self, object__name=self.object, policy=self.policy)
        out = prepare_output_dir(self.out, holds=DEMO)
        from keypush.recording.narration import final_distance
        from keypush.recording.recorder import record_episode

        recording = record_episode(scenario)
        summary = {
            **recording.result.summary,
            "final_distance": final_distance(recording.result),
            "simulated_seconds": recording.result.seconds,
        }
        save_scenario(scenario, out)
        write_output(out / "summary.json", json.dumps(summary, indent=2, default=list) + "\n")
        page = out / "recording.html"
        write_output(page, recording.html)
        print(recording.narration)
        print(f"To watch it, open {page.resolve()} in a browser.")
