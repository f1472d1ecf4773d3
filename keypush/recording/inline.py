"""A page to watch inside a notebook."""

from dataclasses import dataclass
from html import escape


@dataclass(frozen=True)
class InlinePage:
    """A self-contained page, which a notebook shows in a frame where it is a cell's value.

    The page travels in the cell's output and in no file, so that a notebook that is saved with its
    outputs still shows it elsewhere.
    """

    html: str
    """The page."""
    height: int = 500
    """Of the frame, in pixels; it is as wide as the cell."""

    def _repr_html_(self) -> str:
        """Returns what IPython displays; it looks for a method of this name."""
        return (
            f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{self.height}" '
            'style="border: 0"></iframe>'
        )
