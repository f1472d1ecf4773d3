"""A table that knows nothing of how it is written down."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

Row = tuple[str, ...]


@dataclass(frozen=True)
class ReportTable:
    """A table of words and figures, ready to be read."""

    caption: str
    names: Sequence[str]
    """Headings of the leading columns, which name a row."""
    figures: Sequence[str]
    """Headings of the other columns."""
    rows: Sequence[Row]
    note: str = ""
    """What has to be known to read it."""

    @property
    def headings(self) -> list[str]:
        """Headings of all columns."""
        return [*self.names, *self.figures]

    def groups(self) -> Iterator[list[Row]]:
        """Yields neighbouring rows of the same first name together."""
        for _, rows in groupby(self.rows, key=lambda row: row[0]):
            yield list(rows)
