"""Examples of what was evaluated, as a page and as Markdown."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import groupby
from pathlib import Path

from keypush.evaluation.examples import MOMENTS, Choice, Example
from keypush.reporting.page_head import page_head

_HEADINGS = ("object", "episode", "outcome", "how it went", "recording")
_STYLE = Path(__file__).with_name("examples.css")


@dataclass(frozen=True)
class Gallery:
    """What the page and its Markdown show."""

    title: str
    lead: str
    """How the examples were chosen."""
    groups: Sequence[tuple[Choice, Sequence[Example]]]
    """Those of an object lie beside each other."""
    stills: Mapping[Path, Sequence[bytes]] = field(default_factory=dict)
    """JPEGs of the moments of an example, by its page."""

    @property
    def differing(self) -> str:
        """Says whether every episode repeated its record."""
        examples = [example for _, found in self.groups for example in found]
        count = sum(bool(example.differences) for example in examples)
        if not count:
            return f"All {len(examples)} episodes ran as in their records."
        return (
            f"{count} of {len(examples)} episodes did not run as in their records; see there. "
            "Processors of another kind round otherwise."
        )


def render_page(gallery: Gallery) -> str:
    """Writes the examples as a page without script that needs no file but the recordings."""
    # The object stands in a row of its own above its episodes.
    headings = "".join(f'<th scope="col">{text}</th>' for text in _HEADINGS[1:])
    return "\n".join(
        [
            *page_head(gallery.title, _STYLE),
            f"<h1>{escape(gallery.title)}</h1>",
            f"<p>{escape(gallery.lead)}</p>",
            f"<p>{escape(gallery.differing)}</p>",
            "<table>",
            f"<thead><tr>{headings}</tr></thead>",
            *_bodies(gallery),
            "</table>",
            "</body>",
            "</html>\n",
        ]
    )


def render_markdown(gallery: Gallery) -> str:
    """Writes the examples as Markdown, without their stills."""
    lines = [
        f"| {' | '.join(_HEADINGS)} |",
        "|---" * len(_HEADINGS) + "|",
    ]
    for choice, examples in gallery.groups:
        for example in examples:
            link = f"[{example.page.stem}]({example.page.name})"
            cells = [choice.object, _episode(example), example.end, _story(example), link]
            lines.append(f"| {' | '.join(cell.replace('|', '\\|') for cell in cells)} |")
    found = [f"- {choice.object}: {_found(choice)}" for choice, _ in gallery.groups]
    return "\n\n".join(
        [
            f"# {gallery.title}",
            f"{gallery.lead} {gallery.differing}",
            "\n".join(found),
            "\n".join(lines) + "\n",
        ]
    )


def _bodies(gallery: Gallery) -> list[str]:
    bodies = []
    for name, groups in groupby(gallery.groups, key=lambda group: group[0].object):
        mine = list(groups)
        found = "; ".join(_found(choice) for choice, _ in mine)
        shown = escape(name.replace("_", " "))
        bodies.append(
            f'<tbody>\n<tr class="head"><th scope="rowgroup" colspan="{len(_HEADINGS) - 1}">{shown}'
            f"<span>{escape(found)}</span></th></tr>"
        )
        bodies += [_row(example, gallery.stills) for _, examples in mine for example in examples]
        bodies.append("</tbody>")
    return bodies


def _row(example: Example, stills: Mapping[Path, Sequence[bytes]]) -> str:
    kind = "success" if example.record["success"] else "failure"
    pictures = "".join(map(_picture, MOMENTS, stills.get(example.page, ())))
    warning = "".join(f'<br><span class="warning">{escape(d)}</span>' for d in example.differences)
    shown = f'<div class="stills">{pictures}</div>' if pictures else ""
    story = f"{escape(example.course)}{warning}{shown}"
    return (
        f'<tr class="{kind}"><td class="episode">{_episode(example)}</td>'
        f"<td><b>{escape(example.end)}</b></td><td>{story}</td>"
        f'<td class="link"><a href="{escape(example.page.name)}" '
        f'aria-label="watch {escape(example.page.stem)}">watch</a></td></tr>'
    )


def _picture(moment: str, jpeg: bytes) -> str:
    return f'<img alt="{moment}" src="data:image/jpeg;base64,{b64encode(jpeg).decode()}">'


def _episode(example: Example) -> str:
    number = f"episode\N{NO-BREAK SPACE}{example.record['episode']}"
    return f"{number}, {example.condition}" if example.condition else number


def _story(example: Example) -> str:
    return "; ".join([example.course, *(f"**{d}**" for d in example.differences)])


def _found(choice: Choice) -> str:
    kind = "successes" if choice.success else "failures"
    if not choice.found:
        return f"no {kind} in {choice.episodes} episodes"
    return f"{len(choice.records)} of {choice.found} {kind} in {choice.episodes} episodes"
