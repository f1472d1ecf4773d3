"""Summaries as tables for the terminal."""

from collections.abc import Mapping
from typing import Any

from rich.box import SIMPLE
from rich.table import Table

from keypush.evaluation.conditions import AXES, number_text
from keypush.evaluation.summary import ObjectSummary, Summary


def summary_table(summary: Summary, title: str) -> Table:
    """Lays out one line per object, and one for all.

    Where centres of mass were moved less than asked for, a column says in how many episodes.
    """
    capped = "com_capped" in summary
    table = _table(title, "object", capped=capped)
    for name, line in summary["objects"].items():
        table.add_row(name, *_cells(line, capped=capped))
    table.add_section()
    table.add_row("all", *_cells(summary, capped=capped))
    return table


def conditions_table(conditions: Mapping[str, Any]) -> Table:
    """Lays out one line per condition, over all objects, and names what differs.

    Args:
        conditions: as in `summary.json`.
    """
    lines = list(conditions.values())
    fields = [axis for axis in AXES if len({line[axis.name] for line in lines}) > 1]
    capped = any("com_capped" in line for line in lines)
    table = _table("all objects", *(axis.word for axis in fields), capped=capped)
    for line in lines:
        values = [number_text(line[axis.name]) for axis in fields]
        table.add_row(*values, *_cells(line, capped=capped))
    return table


def _table(title: str, *names: str, capped: bool) -> Table:
    table = Table(title=title, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0))
    for name in names:
        table.add_column(name)
    for heading in ("episodes", "success", "95 % interval", "settled", "steps"):
        # A cell stays on one line also where the terminal is narrow; the failures may not.
        table.add_column(heading, justify="right", no_wrap=True)
    if capped:
        table.add_column("COM capped", justify="right")
    table.add_column("failures", justify="left", overflow="fold")
    return table


def _cells(line: ObjectSummary, *, capped: bool) -> list[str]:
    low, high = line["wilson95"]
    steps = line.get("median_steps")
    return [
        str(line["episodes"]),
        f"{line['success_rate']:.1%}",
        f"{low:.1%} to {high:.1%}",
        f"{line['settled_success_rate']:.1%}",
        "-" if steps is None else f"{steps:g}",
        *([f"{line.get('com_capped', 0.0):.1%}"] if capped else []),
        ", ".join(f"{kind} {count}" for kind, count in line["failures"].items()) or "none",
    ]
