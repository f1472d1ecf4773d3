"""How every page begins that needs no script and no network."""

from collections.abc import Iterator
from html import escape
from pathlib import Path

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""Content security policy: browsers themselves refuse whatever the page does not carry."""


def page_head(title: str, style: Path) -> Iterator[str]:
    """Yields the lines of a page up to the start of its body.

    Args:
        title: of the page.
        style: CSS file that the page carries.
    """
    yield "<!doctype html>"
    yield '<html lang="en">'
    yield "<head>"
    yield '<meta charset="utf-8">'
    yield f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
    yield '<meta name="viewport" content="width=device-width, initial-scale=1">'
    yield '<meta name="color-scheme" content="light dark">'
    yield '<link rel="icon" href="data:,">'
    yield f"<title>keypush: {escape(title)}</title>"
    yield f"<style>\n{style.read_text(encoding='utf-8')}</style>"
    yield "</head>"
    yield "<body>"
