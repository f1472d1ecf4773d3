"""Where a diagram's systems and wires go on a page: columns in the direction of the data."""

from collections import defaultdict
from dataclasses import dataclass

Edge = tuple[int, int]


@dataclass(frozen=True)
class Columns:
    """Systems, as indices, in columns from left to right and from top to bottom."""

    columns: list[list[int]]
    backward: frozenset[Edge]
    """Edges that run against the columns: they close a loop."""


def arrange(count: int, edges: list[Edge]) -> Columns:
    """Puts every system to the right of those that feed it, loops aside.

    Args:
        count: number of systems.
        edges: (source, sink) pairs; may repeat and may close loops.
    """
    # A loop has to be cut somewhere: where the fewest wires then lead back.
    cuts = [_loop_closing_edges(count, edges, first) for first in _unfed_first(count, edges)]
    backward = min(cuts, key=lambda cut: sum(edge in cut for edge in edges), default=frozenset())
    forward = sorted({edge for edge in edges if edge not in backward})
    column = [0] * count
    for _ in range(count):
        for source, sink in forward:
            column[sink] = max(column[sink], column[source] + 1)
    columns = [
        [i for i in range(count) if column[i] == c] for c in range(max(column, default=0) + 1)
    ]
    _untangle(columns, forward)
    return Columns(columns, backward)


def _unfed_first(count: int, edges: list[Edge]) -> list[int]:
    fed = {sink for _, sink in edges}
    return sorted(range(count), key=lambda i: (i in fed, i))


def _loop_closing_edges(count: int, edges: list[Edge], first: int) -> frozenset[Edge]:
    """Finds, depth first, the edges that lead back to a system on the path that led to them.

    Args:
        count: number of systems.
        edges: (source, sink) pairs.
        first: where to begin; then from systems that nothing feeds.
    """
    sinks = defaultdict(list)
    for source, sink in sorted(set(edges)):
        sinks[source].append(sink)
    closing = set()
    state = ["new"] * count

    def visit(system: int) -> None:
        state[system] = "open"
        for sink in sinks[system]:
            if state[sink] == "open":
                closing.add((system, sink))
            elif state[sink] == "new":
                visit(sink)
        state[system] = "done"

    for system in [first, *_unfed_first(count, edges)]:
        if state[system] == "new":
            visit(system)
    return frozenset(closing)


def _untangle(columns: list[list[int]], forward: list[Edge]) -> None:
    """Orders each column by the mean height of what feeds it (Sugiyama's barycentre rule)."""
    for column in columns[1:]:
        row = {system: i for members in columns for i, system in enumerate(members)}
        feeders = {
            system: [row[source] for source, sink in forward if sink == system] for system in column
        }
        column.sort(key=lambda s: sum(feeders[s]) / len(feeders[s]) if feeders[s] else 0.0)
