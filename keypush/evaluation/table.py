"""A summary as a table for the terminal."""

from rich.table import Table

from keypush.evaluation.summary import ObjectSummary, Summary


def summary_table(summary: Summary, title: str) -> Table:
    """Lays out one line per object, and one for all.

    Where centres of mass were moved less than asked for, a column says in how many episodes.
    """
    table = Table(title=title, title_justify="left")
    table.add_column("object")
    headings = ["episodes", "success", "95 % interval", "failures"]
    if "com_capped" in summary:
        headings.append("COM capped")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "failures" else "right")
    for name, line in summary["objects"].items():
        table.add_row(name, *_cells(line)[: len(headings)])
    table.add_section()
    table.add_row("all", *_cells(summary)[: len(headings)])
    table.caption = f"settled success {summary['settled_success_rate']:.1%}"
    return table


def _cells(line: ObjectSummary) -> tuple[str, ...]:
    low, high = line["wilson95"]
    failures = ", ".join(f"{kind} {count}" for kind, count in line["failures"].items())
    return (
        str(line["episodes"]),
        f"{line['success_rate']:.1%}",
        f"{low:.1%} to {high:.1%}",
        failures or "none",
        f"{line.get('com_capped', 0.0):.1%}",
    )
