"""Outlines of resting faces: their loops, and fewer corners in them."""

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from keypush.objects.meshing.surface import Surface

Array = NDArray[np.float64]


def outline_loops(surface: Surface, plane: int) -> list[list[int]]:
    """Returns the boundary of a plane's faces as loops of vertices, in the faces' sense."""
    after: dict[int, list[int]] = defaultdict(list)
    directed = set()
    for f, label in surface.labels.items():
        if label == plane:
            a, b, c = surface.faces[f]
            directed |= {(a, b), (b, c), (c, a)}
    for u, v in sorted(directed):
        if (v, u) not in directed:
            after[u].append(v)
    loops = []
    while after:
        start = next(iter(after))
        loop, v = [start], _pop(after, start)
        # Where two faces touch in a point, a loop ends when it comes back to its own start.
        while v != start:
            loop.append(v)
            v = _pop(after, v)
        loops.append(loop)
    return loops


def _pop(after: dict[int, list[int]], v: int) -> int:
    following = after[v].pop()
    if not after[v]:
        del after[v]
    return following


def simplify_outlines(surface: Surface, planes: int, tolerance: float) -> None:
    """Collapses corners of outlines that are within `tolerance` (m) of a line without them."""
    loops = [loop for plane in range(planes) for loop in outline_loops(surface, plane)]
    sides: dict[int, set[frozenset[int]]] = defaultdict(set)
    kept: set[int] = set()
    for loop in loops:
        for before, v, following in zip(loop[-1:] + loop[:-1], loop, loop[1:] + loop[:1],
                                        strict=True):  # fmt: skip
            sides[v].add(frozenset((before, following)))
        kept |= _corners(surface, loop, tolerance)
    # Where outlines meet or part, both need the vertex.
    kept |= {v for v, neighbours in sides.items() if len(neighbours) > 1}
    for loop in loops:
        _drop(surface, loop, kept)


def _drop(surface: Surface, loop: list[int], kept: set[int]) -> None:
    first = next((i for i, v in enumerate(loop) if v in kept), None)
    if first is None:
        return
    previous = loop[first]
    for v in loop[first + 1 :] + loop[:first]:
        if v not in kept and surface.around[v]:
            target = surface.points[previous]
            if surface.can_collapse(v, previous, target):
                surface.collapse(v, previous, target)
                continue
        previous = v


def _corners(surface: Surface, loop: list[int], tolerance: float) -> set[int]:
    """Corners that a closed line keeps.  Source: Douglas and Peucker, 1973."""
    points = np.array([surface.points[v] for v in loop])
    centre = points.mean(axis=0)
    first = int(np.argmax(np.linalg.norm(points - centre, axis=1)))
    order = [(first + i) % len(loop) for i in range(len(loop))]
    far = int(np.argmax(np.linalg.norm(points[order] - points[first], axis=1)))
    keep = {0, far}
    for start, end in ((0, far), (far, len(order))):
        _split(points[[*order, order[0]]], start, end, tolerance, keep)
    return {loop[order[i % len(order)]] for i in keep}


def _split(points: Array, start: int, end: int, tolerance: float, keep: set[int]) -> None:
    if end - start < 2:
        return
    a, b = points[start], points[end]
    inner = points[start + 1 : end] - a
    along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-12)
    offset = np.linalg.norm(inner - np.outer(inner @ along, along), axis=1)
    worst = int(np.argmax(offset))
    if offset[worst] > tolerance:
        middle = start + 1 + worst
        keep.add(middle)
        _split(points, start, middle, tolerance, keep)
        _split(points, middle, end, tolerance, keep)
