"""The benchmark's figures, as one JSON object and as a table."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import chain
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from keypush.bench.compare import ENGINES, REFERENCE, Track
from keypush.scenario import Scenario

Tracks = Mapping[str, Mapping[str, Track]]


def summarise_tracks(scenario: Scenario, tracks: Tracks) -> dict[str, Any]:
    """Returns the figures of CENIC over all objects, then those of every object.

    `rtf`: simulated seconds per wall second, of one object. `speedup`: ratio of two `rtf`.
    `final_position_rms_m` and `steps_ratio`: against the reference, over episodes of the
    same outcome; null where there are none. `_cpu`: per second of this process on a core.
    """
    lines = {name: _object_figures(engines) for name, engines in tracks.items()}

    def all_of(key: str) -> list[float]:
        return [line[key] for line in lines.values()]

    truth = {engine: _truth([o[engine] for o in tracks.values()],
                            [o[REFERENCE] for o in tracks.values()])
             for engine in ("cenic", "mujoco")}  # fmt: skip
    return {
        "rtf_median": median(all_of("rtf")),
        "rtf_worst": min(all_of("rtf")),
        "speedup_vs_discrete_1ms": median(all_of("speedup_vs_discrete_1ms")),
        "speedup_vs_mujoco_2ms": median(all_of("speedup_vs_mujoco_2ms")),
        **truth["cenic"],
        "rtf_median_cpu": median(all_of("rtf_cpu")),
        "rtf_worst_cpu": min(all_of("rtf_cpu")),
        "mujoco": truth["mujoco"],
        "episodes": sum(line["episodes"] for line in lines.values()),
        "seed": scenario.seed,
        "simulation": asdict(scenario.simulation),
        "objects": lines,
    }


def _object_figures(engines: Mapping[str, Track]) -> dict[str, Any]:
    cenic, discrete, mujoco = (engines[name] for name in ENGINES)
    return {
        "episodes": len(cenic.outcomes),
        "rtf": cenic.rtf,
        "rtf_cpu": cenic.rtf_cpu,
        "rtf_discrete_1ms": discrete.rtf,
        "rtf_mujoco_2ms": mujoco.rtf,
        "speedup_vs_discrete_1ms": cenic.rtf / discrete.rtf,
        "speedup_vs_mujoco_2ms": cenic.rtf / mujoco.rtf,
        **_truth([cenic], [discrete]),
        "outcomes": {name: engines[name].outcomes for name in ENGINES},
    }


def _truth(tracks: Sequence[Track], references: Sequence[Track]) -> dict[str, float | None]:
    """Compares final positions, outcomes and steps with the reference's."""
    ours, theirs = _joined(tracks, "outcomes"), _joined(references, "outcomes")
    same = ours == theirs
    offset = (_joined(tracks, "positions") - _joined(references, "positions"))[same]
    steps, reference_steps = _joined(tracks, "steps")[same], _joined(references, "steps")[same]
    none = not same.any()
    return {
        "final_position_rms_m": None if none else float(np.sqrt(np.mean(np.sum(offset**2, 1)))),
        "outcome_agreement": float(same.mean()),
        "steps_ratio_vs_reference": None if none else float(steps.mean() / reference_steps.mean()),
    }


def _joined(tracks: Sequence[Track], name: str) -> NDArray[Any]:
    return np.array(list(chain.from_iterable(getattr(track, name) for track in tracks)))


def report_table(report: Mapping[str, Any]) -> Table:
    """Lays out one line per object, and the figures over all of them."""
    table = Table(title="Simulated seconds per wall second, one core", title_justify="left")
    table.add_column("object")
    for heading in ("N", "CENIC", "1 ms", "MuJoCo", "agree", "RMS", "steps"):
        table.add_column(heading, justify="right")
    for name, line in report["objects"].items():
        rtfs = [f"{line[key]:.1f}" for key in ("rtf", "rtf_discrete_1ms", "rtf_mujoco_2ms")]
        table.add_row(name, str(line["episodes"]), *rtfs, *_truth_cells(line))
    table.add_section()
    table.add_row(
        "all", str(report["episodes"]), f"{report['rtf_median']:.1f}", "", "", *_truth_cells(report)
    )
    table.caption = (
        f"median {report['rtf_median']:.1f}, worst {report['rtf_worst']:.1f}; median speed-up "
        f"{report['speedup_vs_discrete_1ms']:.1f} over discrete 1 ms, "
        f"{report['speedup_vs_mujoco_2ms']:.2f} over MuJoCo 2 ms.\n"
        "Against the reference, Drake's discrete model at 1 ms: same outcome, and where it is "
        "the same, distance of final positions and ratio of steps."
    )
    return table


def _truth_cells(line: Mapping[str, Any]) -> tuple[str, str, str]:
    rms, ratio = line["final_position_rms_m"], line["steps_ratio_vs_reference"]
    return (
        f"{line['outcome_agreement']:.0%}",
        "-" if rms is None else f"{1000 * rms:.1f} mm",
        "-" if ratio is None else f"{ratio:.3f}",
    )
