"""A page inside a notebook."""

import re
from html import unescape

from IPython.core.formatters import DisplayFormatter

from keypush.recording.inline import InlinePage

PAGE = '<html><body title="a">it\'s <b>1 &lt; 2</b> & more</body></html>'


def test_a_notebook_displays_the_page_unchanged_in_a_frame() -> None:
    formatter = DisplayFormatter()
    shown, _ = formatter.format(InlinePage(PAGE, height=321))  # type: ignore[no-untyped-call]  # IPython has no types
    frame = re.fullmatch(r'<iframe srcdoc="([^"]*)" [^<>]*height="321"[^<>]*></iframe>',
                         shown["text/html"])  # fmt: skip
    assert frame is not None
    assert unescape(frame[1]) == PAGE
