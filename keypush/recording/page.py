"""Turns Meshcat's bare page into one that says what it shows and has a time bar."""

from html import escape
from pathlib import Path

from pydrake.geometry import Rgba

from keypush.recording.narration import Narration
from keypush.recording.observations import CLOUD_COLOUR, KEYPOINT_COLOUR
from keypush.recording.scenery import GOAL_COLOUR

_OVERLAY = Path(__file__).with_name("overlay.html")
_TITLE, _END = "<title>Drake MeshCat</title>", "</body>"
_LEGEND = (
    (GOAL_COLOUR, "goal"),
    (CLOUD_COLOUR, "point cloud"),
    (KEYPOINT_COLOUR, "keypoint and direction of the push"),
)


def dress_page(html: str, narration: Narration) -> str:
    """Adds title, story, legend and a time bar to `Meshcat.StaticHtml()`.

    Raises:
        RuntimeError: Meshcat's page has changed its form.
    """
    head, title, rest = html.partition(_TITLE)
    body, end, tail = rest.rpartition(_END)
    if not (title and end):
        raise RuntimeError("Meshcat's static page has no title or no end of its body")
    new_title = f"<title>keypush: {escape(narration.title)}</title>"
    return "".join([head, new_title, body, _overlay(narration), end, tail])


def _overlay(narration: Narration) -> str:
    legend = "".join(
        f'<li><span style="background:{_css(colour)}"></span>{escape(text)}</li>'
        for colour, text in _LEGEND
    )
    parts = {
        "TITLE": escape(narration.title),
        "POLICY": escape(narration.policy),
        "OUTCOME": escape(narration.outcome),
        "LEGEND": legend,
    }
    overlay = _OVERLAY.read_text(encoding="utf-8")
    for name, text in parts.items():
        overlay = overlay.replace(f"{{{{{name}}}}}", text)
    return overlay


def _css(colour: Rgba) -> str:
    return f"rgb({255 * colour.r():.0f} {255 * colour.g():.0f} {255 * colour.b():.0f})"
