"""Small drawings as SVG whose colours come from the page's style sheet.

A drawing is as wide as a phone's page and is never stretched, so that its text keeps its size.
"""

from collections.abc import Sequence
from html import escape

WIDTH = 340
"""Width of a drawing in pixels."""
SHAPES = (
    "M-3.2 0a3.2 3.2 0 1 0 6.4 0a3.2 3.2 0 1 0-6.4 0z",  # circle
    "M-2.9-2.9h5.8v5.8h-5.8z",  # square
    "M0-3.8L3.6 2.8H-3.6z",  # triangle
    "M0-4.2L4.2 0L0 4.2L-4.2 0z",  # diamond
    "M0 3.8L3.6-2.8H-3.6z",  # triangle that points down
    "M-1.3-3.9h2.6v2.6h2.6v2.6h-2.6v2.6h-2.6v-2.6h-2.6v-2.6h2.6z",  # plus
    "M-3.8 0L-2.4-2.8H2.4L3.8 0L2.4 2.8H-2.4z",  # hexagon
    "M3.8 0L-2.8-3.6V3.6z",  # triangle that points left
    "M-3.8-1.5H3.8V1.5H-3.8z",  # bar
)
"""Outlines of marks about (0, 0): with a colour alone, who sees few colours would be lost."""


class Drawing:
    """An SVG picture that grows by what is drawn."""

    def __init__(self, height: float) -> None:
        """Args: its height in pixels."""
        self._height = height
        self._parts: list[str] = []

    def line(self, ends: Sequence[float], style: str) -> None:
        """Draws a line from (x1, y1) to (x2, y2), given as one sequence."""
        x1, y1, x2, y2 = map(_short, ends)
        self._parts.append(f'<path class="{style}" d="M{x1} {y1}L{x2} {y2}"/>')

    def path(self, points: Sequence[tuple[float, float]], style: str) -> None:
        """Draws an open line through points."""
        if points:
            through = "L".join(f"{_short(x)} {_short(y)}" for x, y in points)
            self._parts.append(f'<path class="{style}" d="M{through}"/>')

    def rectangle(
        self, corner: tuple[float, float], size: tuple[float, float], style: str, told: str = ""
    ) -> None:
        """Draws a rectangle from its upper left corner."""
        x, y, width, height = map(_short, (*corner, *size))
        self._parts.append(
            f'<rect class="{style}" x="{x}" y="{y}" width="{width}" height="{height}">'
            f"{_title(told)}</rect>"
        )

    def text(self, at: tuple[float, float], text: str, style: str) -> None:
        """Writes text; the style sheet says which end of it is at the point."""
        x, y = map(_short, at)
        self._parts.append(f'<text class="{style}" x="{x}" y="{y}">{escape(text)}</text>')

    def mark(self, shape: int, at: tuple[float, float], style: str, told: str = "") -> None:
        """Draws one of `SHAPES`."""
        x, y = map(_short, at)
        outline = SHAPES[shape % len(SHAPES)]
        self._parts.append(
            f'<path class="{style}" transform="translate({x} {y})" d="{outline}">'
            f"{_title(told)}</path>"
        )

    def dots(self, points: Sequence[tuple[float, float]], style: str) -> None:
        """Draws many dots as one path, which keeps the page small."""
        strokes = "".join(f"M{_short(x)} {_short(y)}h0" for x, y in points)
        if strokes:
            self._parts.append(f'<path class="{style}" d="{strokes}"/>')

    def render(self, alternative: str) -> str:
        """Returns the picture; `alternative` says in words what it shows."""
        size = f'viewBox="0 0 {WIDTH} {_short(self._height)}" width="{WIDTH}"'
        return (
            f'<svg role="img" aria-label="{escape(alternative)}" {size} '
            f'height="{_short(self._height)}">{"".join(self._parts)}</svg>'
        )


def symbol(shape: int, style: str) -> str:
    """Returns one of `SHAPES` as a picture of its own, for a legend."""
    return (
        '<svg aria-hidden="true" viewBox="-6 -6 12 12" width="14" height="14">'
        f'<path class="{style}" d="{SHAPES[shape % len(SHAPES)]}"/></svg>'
    )


def _short(number: float) -> str:
    return f"{number:.1f}".removesuffix(".0")


def _title(told: str) -> str:
    return f"<title>{escape(told)}</title>" if told else ""
