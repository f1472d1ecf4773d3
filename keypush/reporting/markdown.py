"""A report as Markdown: its words and tables, without its figures."""

import re

from keypush.reporting.report import Report
from keypush.reporting.table import ReportTable

_TAG = re.compile(r"<(?=[A-Za-z/!?])")


def render_markdown(report: Report) -> str:
    """Writes a report's words and tables as Markdown."""
    parts = [f"# {report.title}", report.lead]
    parts.append("\n".join(f"- {_line(name)}: {_line(text)}" for name, text in report.facts))
    for section in report.sections:
        if not (section.text or section.tables):
            continue
        parts.append(f"## {section.title}")
        if section.text:
            parts.append(section.text)
        parts.extend(_table(table) for table in section.tables)
    return "\n\n".join(parts) + "\n"


def _table(table: ReportTable) -> str:
    rules = ["---"] * len(table.names) + ["---:"] * len(table.figures)
    lines = [table.headings, rules, *table.rows]
    text = "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines)
    note = f"\n\n{table.note}" if table.note else ""
    return f"**{table.caption}**\n\n{text}{note}"


def _cell(text: str) -> str:
    return _line(text).replace("|", "\\|")


def _line(text: str) -> str:
    """What came from files or a policy must not be taken for HTML, nor break a line."""
    return _TAG.sub("&lt;", " ".join(text.split()))
