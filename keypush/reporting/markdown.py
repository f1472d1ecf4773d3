"""A report as Markdown: its words and tables, without its figures."""

from keypush.reporting.report import Report
from keypush.reporting.table import ReportTable


def render_markdown(report: Report) -> str:
    """Writes a report's words and tables as Markdown."""
    parts = [f"# {report.title}", report.lead]
    parts.append("\n".join(f"- {name}: {text}" for name, text in report.facts))
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
    return text.replace("|", "\\|")
