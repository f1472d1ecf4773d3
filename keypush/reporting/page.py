"""A report as one page that needs no other file, no script and no network."""

from collections.abc import Sequence
from html import escape
from itertools import groupby
from pathlib import Path

from keypush import __version__
from keypush.reporting.figure import Figure
from keypush.reporting.page_head import page_head
from keypush.reporting.report import Report, Section
from keypush.reporting.runs import Recording
from keypush.reporting.table import ReportTable, Row

_STYLE = Path(__file__).with_name("style.css")


def render_page(report: Report, recordings: Sequence[Recording]) -> str:
    """Writes a report as HTML.

    Args:
        report: what to show.
        recordings: pages of single episodes to link to.
    """
    sections = [_section(number, section) for number, section in enumerate(report.sections)]
    entries = [
        f'<a href="#s{number}">{escape(section.title)}</a>'
        for number, section in enumerate(report.sections)
    ]
    if recordings:
        sections.append(_recordings(recordings))
        entries.append('<a href="#recordings">Recordings</a>')
    return "\n".join(
        [
            *page_head(report.title, _STYLE),
            "<header>",
            f"<h1>{escape(report.title)}</h1>",
            f'<p class="lead">{escape(report.lead)}</p>',
            _facts(report),
            f'<nav aria-label="Sections">{"".join(entries)}</nav>',
            "</header>",
            "<main>",
            *sections,
            "</main>",
            f"<footer>keypush {escape(__version__)}</footer>",
            "</body>",
            "</html>\n",
        ]
    )


def _facts(report: Report) -> str:
    lines = [
        f"<div><dt>{escape(name)}</dt><dd>{escape(text)}</dd></div>" for name, text in report.facts
    ]
    return f"<dl>{''.join(lines)}</dl>"


def _section(number: int, section: Section) -> str:
    text = f"<p>{escape(section.text)}</p>\n" if section.text else ""
    parts = "\n".join([*map(_figure, section.figures), *map(_table, section.tables)])
    body = f'<div class="body">\n{parts}\n</div>\n' if parts else ""
    title = escape(section.title)
    return f'<section id="s{number}">\n<h2>{title}</h2>\n{text}{body}</section>'


def _figure(figure: Figure) -> str:
    legend = "".join(f"<li>{mark}{escape(name)}</li>" for mark, name in figure.legend)
    panels = "".join(
        f'<div class="panel"><h3>{escape(heading)}</h3>{svg}</div>'
        for heading, svg in figure.panels
    )
    single = ' class="single"' if len(figure.panels) == 1 else ""
    return (
        f"<figure{single}>\n<figcaption>{escape(figure.caption)}</figcaption>\n"
        f'<ul class="legend">{legend}</ul>\n<div class="panels">{panels}</div>\n</figure>'
    )


def _table(table: ReportTable) -> str:
    names, caption = len(table.names), escape(table.caption)
    headings = "".join(
        f'<th scope="col"{_figure_class(i, names)}>{escape(text)}</th>'
        for i, text in enumerate(table.headings)
    )
    bodies = "\n".join(
        f"<tbody>{''.join(_row(rows, i, names) for i in range(len(rows)))}</tbody>"
        for rows in table.groups()
    )
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ""
    # The box can be scrolled from the keyboard too, so it takes the focus and has a name.
    return (
        '<div class="tabled">\n'
        f'<div class="scroll" tabindex="0" role="region" aria-label="{caption}">\n'
        f"<table>\n<caption><span>{caption}</span></caption>\n<thead><tr>{headings}</tr></thead>\n"
        f"{bodies}\n</table>\n</div>\n{note}</div>"
    )


def _row(rows: Sequence[Row], index: int, names: int) -> str:
    """One row of a group. A name that stays the same stands once, beside all its rows."""
    row = rows[index]
    cells = [_name(rows, index, column) for column in range(names - 1)]
    cells.append(f'<th scope="row">{escape(row[names - 1])}</th>')
    cells.extend(f"<td>{escape(text)}</td>" for text in row[names:])
    part = ' class="part"' if index and any(cells[: names - 1]) else ""
    return f"<tr{part}>{''.join(cells)}</tr>"


def _name(rows: Sequence[Row], index: int, column: int) -> str:
    """A name's cell where the name is new, else nothing."""
    names = [row[: column + 1] for row in rows]
    if index and names[index - 1] == names[index]:
        return ""
    text, first = escape(rows[index][column]), ""
    if column == 0:  # stays in view on a phone, where it must be narrow
        text, first = text.replace("_", "_<wbr>"), ' class="first"'
    return f'<th scope="rowgroup"{first} rowspan="{names.count(names[index])}">{text}</th>'


def _figure_class(column: int, names: int) -> str:
    return "" if column < names else ' class="figure"'


def _recordings(recordings: Sequence[Recording]) -> str:
    parts = []
    for group, found in groupby(recordings, key=lambda recording: recording.group):
        links = "".join(
            f'<li><a href="{escape(recording.address)}">{escape(recording.name)}</a></li>'
            for recording in found
        )
        parts.append(f"<h3>{escape(group)}</h3>\n<ul class='links'>{links}</ul>")
    return '<section id="recordings">\n<h2>Recordings</h2>\n' + "\n".join(parts) + "\n</section>"
