"""Writes the tables and plots of `docs/expert.md` from what `study_expert.py` ran.

    scripts/uv.sh run scripts/report_expert.py RUNS

`docs/expert.md` holds the words; what lies between its markers is replaced. The episodes go to
`docs/results/expert.parquet`, so that every figure can be computed again; conditions that RUNS
lacks are taken from there, and a line names those that it has.
"""

import re
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from as_command import as_command

from keypush.dataset.job_file import read_job
from keypush.errors import UserError
from keypush.evaluation.summary import summarise
from keypush.objects.catalogue import catalogue_names

mpl.use("Agg")
import matplotlib.pyplot as plt

DOCS = Path(__file__).parent.parent / "docs"
RECORDS = DOCS / "results" / "expert.parquet"
_COLUMNS = ["object", "size_ratio", "seed", "episode", "success", "settled_success", "outcome",
            "steps", "redrawn", "com_capped"]  # fmt: skip
_EVERYWHERE = ("tuned", "size_0.75", "size_1.25", "com_shift", "com_shift_struck", "reset",
               "thesis")  # fmt: skip
_ONE_FIELD = "few"

Episodes = list[dict[str, Any]]


def read_runs(runs: Path) -> dict[str, Episodes]:
    """Reads the episodes of every condition, by its folder's name.

    Raises:
        UserError: there is none, or one is not finished.
    """
    found = {}
    for folder in sorted(path.parent for path in runs.glob("*/job.yaml")):
        objects, episodes = read_job(folder / "job.yaml")
        files = sorted((folder / "episodes").glob("*.parquet"))
        tables = [pq.read_table(file).select(_COLUMNS) for file in files]
        there = sum(map(len, tables))
        if there != len(objects) * episodes:
            raise UserError(
                f"{folder}: {there} of {len(objects) * episodes} episodes are there; allowed: "
                "conditions that study_expert.py has finished"
            )
        found[folder.name] = pa.concat_tables(tables).to_pylist()
    if not found:
        raise UserError(f"{runs}: holds no condition; allowed: a folder of study_expert.py")
    return found


def read_records() -> dict[str, Episodes]:
    """Reads the episodes that were reported before, by condition."""
    found: dict[str, Episodes] = {}
    for episode in pq.read_table(RECORDS).to_pylist():
        found.setdefault(episode.pop("condition"), []).append(episode)
    return found


def condition_table(runs: dict[str, Episodes], names: list[str]) -> str:
    """Returns one Markdown row per condition."""
    lines = [
        (
            "| condition | episodes | success (95 % interval) | settled | worst object | toppled "
            "| fell | timed out | steps | starts dropped |"
        ),
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name in names:
        episodes = runs[name]
        summary = summarise(episodes)
        low, high = summary["wilson95"]
        worst = min(summary["objects"].items(), key=lambda item: item[1]["success_rate"])
        steps = [e["steps"] for e in episodes if e["success"]]
        dropped = sum(e["redrawn"] for e in episodes)
        failures = [summary["failures"].get(kind, 0) for kind in ("toppled", "fell", "timed_out")]
        cells = [
            f"`{name}`",
            str(len(episodes)),
            f"{summary['success_rate']:.1%} ({low:.1%} to {high:.1%})",
            f"{summary['settled_success_rate']:.1%}",
            f"{worst[0]} {worst[1]['successes']}/{worst[1]['episodes']}",
            *map(str, failures),
            f"{np.mean(steps):.0f}" if steps else "-",
            f"{dropped / (len(episodes) + dropped):.1%}",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def integrator_table(runs: dict[str, Episodes]) -> str:
    """Returns success and steps of the same episodes under both integrators."""
    reference = {(e["object"], e["episode"]): e for e in runs["discrete"]}
    ours = {key: e for e in runs["tuned"] if (key := (e["object"], e["episode"])) in reference}
    both = [(e, reference[key]) for key, e in ours.items()]
    agree = np.mean([mine["success"] == theirs["success"] for mine, theirs in both])
    steps = np.array(
        [(m["steps"], t["steps"]) for m, t in both if m["success"] and t["success"]], dtype=float
    )
    rates = [np.mean([pair[side]["success"] for pair in both]) for side in (0, 1)]
    lines = [
        "| | error-controlled | discrete, 1 ms | difference |",
        "|---|---|---|---|",
        (
            f"| success, {len(both)} episodes | {rates[0]:.1%} | {rates[1]:.1%} "
            f"| {100 * (rates[0] - rates[1]):+.1f} points |"
        ),
        (
            f"| steps to the goal | {steps[:, 0].mean():.1f} | {steps[:, 1].mean():.1f} "
            f"| {steps[:, 0].mean() / steps[:, 1].mean() - 1:+.1%} |"
        ),
        f"| same outcome | | | {agree:.1%} of the episodes |",
    ]
    return "\n".join(lines)


def object_table(runs: dict[str, Episodes], names: list[str]) -> str:
    """Returns one Markdown row per object: successes under every condition."""
    lines = [
        f"| object | {' | '.join(f'`{name}`' for name in names)} |",
        "|---" * (len(names) + 1) + "|",
    ]
    summaries = {name: summarise(runs[name])["objects"] for name in names}
    for shape in catalogue_names():
        cells = []
        for name in names:
            mine = summaries[name].get(shape)
            cells.append(f"{mine['successes']}/{mine['episodes']}" if mine else "")
        lines.append(f"| {shape} | {' | '.join(cells)} |")
    return "\n".join(lines)


def draw(runs: dict[str, Episodes], names: list[str], path: Path) -> None:
    """Draws success with its interval, and steps to the goal, by condition."""
    figure, (rates, steps) = plt.subplots(1, 2, figsize=(10, 0.32 * len(names) + 1.2), sharey=True)
    for row, name in enumerate(names):
        summary = summarise(runs[name])
        low, high = summary["wilson95"]
        rate = summary["success_rate"]
        rates.errorbar(
            rate, row, xerr=[[rate - low], [high - rate]], fmt="o", color="tab:blue", capsize=3
        )
        taken = [e["steps"] for e in runs[name] if e["success"]]
        steps.boxplot(
            taken, positions=[row], orientation="horizontal", widths=0.6, showfliers=False
        )
    rates.set_yticks(range(len(names)), names)
    rates.invert_yaxis()
    rates.set_xlabel("success, 95 % Wilson interval")
    steps.set_yticks(range(len(names)), names)
    steps.set_xlabel("policy steps to the goal")
    for axes in (rates, steps):
        axes.grid(axis="x", alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _replace(text: str, marker: str, content: str) -> str:
    pattern = rf"(<!-- {marker} -->\n).*?(<!-- end -->)"
    return re.sub(pattern, lambda match: f"{match[1]}{content}\n{match[2]}", text, flags=re.S)


def main(runs: Path) -> None:
    """Replaces tables, plots and records.

    Args:
        runs: the folder of the study.
    """
    fresh = read_runs(runs)
    print(f"replaced: {', '.join(fresh)}")
    _write(read_records() | fresh)


def _write(runs: dict[str, Episodes]) -> None:
    everywhere = [name for name in _EVERYWHERE if name in runs]
    fields = sorted(name for name in runs if name.startswith(_ONE_FIELD))
    page = DOCS / "expert.md"
    text = page.read_text(encoding="utf-8")
    text = _replace(text, "conditions", condition_table(runs, everywhere))
    text = _replace(text, "objects", object_table(runs, everywhere))
    text = _replace(text, "fields", condition_table(runs, fields))
    if "discrete" in runs:
        text = _replace(text, "integrators", integrator_table(runs))
    page.write_text(text, encoding="utf-8")
    draw(runs, [*everywhere, *fields], DOCS / "expert.png")
    kept = [*everywhere, *fields, *(["discrete"] if "discrete" in runs else [])]
    rows = [{"condition": name, **e} for name in kept for e in runs[name]]
    pq.write_table(pa.Table.from_pylist(rows), RECORDS, compression="zstd")


if __name__ == "__main__":
    as_command(main)
