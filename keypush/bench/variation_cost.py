"""What it costs to begin an episode with an object that differs from the last one's."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import median
from typing import Any

from rich.table import Table
from tqdm import tqdm

from keypush.rollout.episode import EpisodeRunner
from keypush.scenario import Scenario, VariationConfig

PLAIN = "nothing"
_FACTORS = [0.5, 1.5]
VARIATIONS: dict[str, VariationConfig] = {
    PLAIN: VariationConfig(),
    "mass_com_inertia": VariationConfig(mass=[0.5, 2.0], com_shift=0.015),
    "frictions": VariationConfig(
        object_friction=_FACTORS, table_friction=_FACTORS, gripper_friction=_FACTORS
    ),
    "size": VariationConfig(size=[0.75, 1.25]),
}
"""What varies, by the name in the report; the first is what the others are compared with."""

Times = dict[str, list[float]]


def measure_resets(scenario: Scenario, objects: Sequence[str], episodes: int) -> dict[str, Times]:
    """Times the resets of the same episodes under each of `VARIATIONS`, in this process.

    They take turns, episode by episode, so that whatever else the machine does slows all of
    them alike. A progress bar shows on a terminal.

    Args:
        scenario: all constants but `variation`, which is replaced.
        objects: catalogue names.
        episodes: number per object, from 1; episode 0 warms up.

    Returns:
        Wall time in s by object, variation and episode.

    Raises:
        UserError: the scenario's fields have no room for a variation.
    """
    times: dict[str, Times] = {}
    with tqdm(total=len(objects) * episodes, unit="episode", disable=None) as bar:
        for name in objects:
            bar.set_postfix_str(name)
            shown = replace(scenario, object=replace(scenario.object, name=name))
            runners = {
                kind: EpisodeRunner(replace(shown, variation=variation))
                for kind, variation in VARIATIONS.items()
            }
            for runner in runners.values():
                runner.reset(0)
            times[name] = {kind: [] for kind in runners}
            for episode in range(1, episodes + 1):
                for kind, runner in runners.items():
                    times[name][kind].append(_time_reset(runner, episode))
                bar.update()
    return times


def _time_reset(runner: EpisodeRunner, episode: int) -> float:
    start = time.perf_counter()
    runner.reset(episode)
    return time.perf_counter() - start


def summarise_resets(scenario: Scenario, times: Mapping[str, Times]) -> dict[str, Any]:
    """Returns median milliseconds per reset and their ratios to the plain reset.

    Over all objects, an object counts by its median.
    """
    objects = {
        name: _figures({kind: 1e3 * median(mine) for kind, mine in kinds.items()})
        for name, kinds in times.items()
    }
    overall = {
        kind: median(line["reset_ms"][kind] for line in objects.values()) for kind in VARIATIONS
    }
    return {
        **_figures(overall),
        "episodes": sum(len(kinds[PLAIN]) for kinds in times.values()),
        "seed": scenario.seed,
        "objects": objects,
    }


def _figures(milliseconds: dict[str, float]) -> dict[str, dict[str, float]]:
    plain = milliseconds[PLAIN]
    return {
        "reset_ms": milliseconds,
        "ratio_to_plain": {kind: ms / plain for kind, ms in milliseconds.items()},
    }


def resets_table(report: Mapping[str, Any]) -> Table:
    """Lays out one line per object, and one for all."""
    table = Table(title="Milliseconds per reset, by what varies", title_justify="left")
    table.add_column("object")
    for kind in VARIATIONS:
        table.add_column(kind.replace("_", " "), justify="right")
    for name, line in report["objects"].items():
        table.add_row(name, *_cells(line))
    table.add_section()
    table.add_row("all", *_cells(report))
    table.caption = "in brackets: times the reset in which nothing varies"
    return table


def _cells(line: Mapping[str, Any]) -> list[str]:
    return [
        f"{ms:.1f} ({line['ratio_to_plain'][kind]:.1f})" for kind, ms in line["reset_ms"].items()
    ]
