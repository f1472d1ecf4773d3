"""Reads the tables of a page back, with cells that stand beside several rows written out."""

from html.parser import HTMLParser

Grid = list[list[str]]


class _Tables(HTMLParser):
    """Collects (text, rowspan) of every cell, row by row, table by table."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[list[list[tuple[str, int]]]] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("th", "td"):
            self._inside = True
            self.tables[-1][-1].append(("", int(dict(attrs).get("rowspan") or 1)))

    def handle_endtag(self, tag: str) -> None:
        if tag in ("th", "td"):
            self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside:
            text, span = self.tables[-1][-1].pop()
            self.tables[-1][-1].append((text + data, span))


def read_tables(html: str) -> list[Grid]:
    """Returns every table as rows of as many cells, the headings first."""
    parser = _Tables()
    parser.feed(html)
    return [_written_out(table) for table in parser.tables]


def _written_out(table: list[list[tuple[str, int]]]) -> Grid:
    columns = len(table[0])
    grid: Grid = []
    left = [0] * columns  # rows that the cell above still stands beside
    for row in table:
        cells = iter(row)
        texts = []
        for column in range(columns):
            if left[column]:
                texts.append(grid[-1][column])
            else:
                text, left[column] = next(cells)
                texts.append(text)
            left[column] -= 1
        assert next(cells, None) is None, "a row has too many cells"
        grid.append(texts)
    assert not any(left), "a cell stands beside rows that are not there"
    return grid
