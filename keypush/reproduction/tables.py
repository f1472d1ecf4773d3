"""What was reproduced, as Markdown."""

from collections.abc import Iterator, Mapping, Sequence

from keypush.reporting.episodes import told_failures
from keypush.reproduction.comparisons import Comparison, Results
from keypush.reproduction.throughput import Session, rate

_COMPARED = ("policy", "thesis", "ours", "95 % interval", "difference", "N")
_NUMBERS = "---:"


def comparison_table(first: str, lines: Sequence[Comparison]) -> str:
    """Lays out comparisons; a column tells of capped shifts where there are any.

    Args:
        first: heading of the column of conditions.
        lines: of one table.
    """
    capped = any("com_capped" in line.ours for line in lines)
    headings = [first, *_COMPARED, *(["COM capped"] if capped else [])]
    return _table(headings, 2, (_compared(line, capped=capped) for line in lines))


def measures_table(results: Results, objects: Sequence[str]) -> str:
    """Lays out what else was measured of every policy, with objects as they are."""
    found = {policy: results.summary(policy, objects) for policy in results.policies}
    kinds = told_failures(
        {kind for summary in found.values() if summary for kind in summary["failures"]}
    )
    headings = [
        "policy", "success", "settled success", *(kind.replace("_", " ") for kind in kinds),
        "steps (median)", "object path (m)", "tool path (m)", "keypoint error (mm)", "N",
    ]  # fmt: skip
    rows = []
    for policy, summary in found.items():
        if summary is None:
            continue
        count = summary["episodes"]
        failed = [summary["failures"].get(kind, 0) for kind in kinds]
        error = summary.get("mean_keypoint_error")
        rows.append(
            [
                policy,
                _percent(100 * summary["success_rate"]),
                _percent(100 * summary["settled_success_rate"]),
                *(_percent(100 * number / count) for number in failed),
                _number(summary.get("median_steps"), "g"),
                _number(summary.get("mean_object_path"), ".2f"),
                _number(summary.get("mean_tool_path"), ".2f"),
                _number(None if error is None else 1000 * error, ".1f"),
                str(count),
            ]
        )
    return _table(headings, 1, rows)


def throughput_table(sessions: Mapping[str, Sequence[Session]]) -> str:
    """Lays out episodes per second of every policy."""
    rows = []
    for policy, mine in sessions.items():
        workers = sorted({session.workers for session in mine})
        rows.append(
            [
                policy,
                str(sum(session.episodes for session in mine)),
                _number(sum(session.seconds for session in mine), ".0f"),
                ", ".join(map(str, workers)) or "-",
                _number(rate(mine), ".2f"),
            ]
        )
    return _table(["policy", "episodes", "seconds", "workers", "episodes/s"], 1, rows)


def _compared(line: Comparison, *, capped: bool) -> list[str]:
    low, high = (100 * end for end in line.ours["wilson95"])
    return [
        line.condition,
        line.policy,
        "-" if line.thesis is None else _percent(line.thesis),
        _percent(100 * line.ours["success_rate"]),
        f"{low:.1f} to {high:.1f}",
        _number(line.difference, "+.1f"),
        str(line.ours["episodes"]),
        *([_percent(100 * line.ours.get("com_capped", 0.0))] if capped else []),
    ]


def _table(headings: Sequence[str], names: int, rows: Iterator[list[str]] | list[list[str]]) -> str:
    """Lays out a table whose first columns are words and the others numbers."""
    rules = ["---"] * names + [_NUMBERS] * (len(headings) - names)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (headings, rules, *rows))


def _percent(value: float) -> str:
    return f"{value:.1f} %"


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
