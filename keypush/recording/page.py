"""Turns Meshcat's bare page into one that says what it shows."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from pydrake.geometry import Rgba

_FOLDER = Path(__file__).parent
_TITLE, _END = "<title>Drake MeshCat</title>", "</body>"

Legend = Sequence[tuple[Rgba, str]]


def dress_page(
    html: str, title: str, story: Sequence[str], legend: Legend, *, time_bar: bool
) -> str:
    """Adds title, story, legend and a time bar to `Meshcat.StaticHtml()`.

    Args:
        html: Meshcat's page.
        title: of the page, and the first line of the story.
        story: paragraphs; the last one is printed bold.
        legend: colours and what they stand for.
        time_bar: whether the page plays a recording.

    Raises:
        RuntimeError: Meshcat's page has changed its form.
    """
    head, found, rest = html.partition(_TITLE)
    body, end, tail = rest.rpartition(_END)
    if not (found and end):
        raise RuntimeError("Meshcat's static page has no title or no end of its body")
    parts = [_read("style.html"), _story(title, story, legend)]
    if time_bar:
        parts.append(_read("time_bar.html"))
    new_title = f"<title>keypush: {escape(title)}</title>"
    return "".join([head, new_title, body, *parts, end, tail])


def _story(title: str, story: Sequence[str], legend: Legend) -> str:
    paragraphs = [f"<p>{escape(text)}</p>" for text in story[:-1]]
    paragraphs.append(f"<p><b>{escape(story[-1])}</b></p>")
    entries = [
        f'<li><span style="background:{_css(colour)}"></span>{escape(text)}</li>'
        for colour, text in legend
    ]
    return (
        f'<div id="keypush-story" class="keypush">\n<h1>{escape(title)}</h1>\n'
        f"{''.join(paragraphs)}\n<ul>{''.join(entries)}</ul>\n</div>\n"
    )


def _read(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")


def _css(colour: Rgba) -> str:
    return f"rgb({255 * colour.r():.0f} {255 * colour.g():.0f} {255 * colour.b():.0f})"
