"""Draws a Drake diagram as SVG, without Graphviz: systems as boxes with their named ports."""

from dataclasses import dataclass
from html import escape

from pydrake.systems.framework import Diagram, InputPortIndex, OutputPortIndex, System

from diagrams.layout import arrange

_ROW = 16.0
_GAP_X, _GAP_Y = 90.0, 26.0
_CHARACTER = 6.1
_MANY_PORTS = 12
"""A system with more ports than this shows only those that are used."""
_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#17becf", "#bc8c00")
_STYLE = "text{font:11px sans-serif} .title{font-weight:bold} .box{fill:#f7f7f7;stroke:#333}"


@dataclass
class _Box:
    """A system on the page; its ports are those that are drawn, by index, with their names."""

    name: str
    kind: str
    inputs: dict[int, str]
    outputs: dict[int, str]
    exported: set[tuple[bool, int]]
    """(is output, index) of the ports that the diagram offers to the outside."""
    x: float = 0.0
    y: float = 0.0

    @property
    def width(self) -> float:
        ports = sum(max(map(len, p.values()), default=0) for p in (self.inputs, self.outputs))
        return _CHARACTER * max(ports + 4, len(self.name) + 2, len(self.kind) + 2)

    @property
    def height(self) -> float:
        return _ROW * (2.6 + max(len(self.inputs), len(self.outputs)))

    def port(self, index: int, output: bool) -> tuple[float, float]:
        row = list(self.outputs if output else self.inputs).index(index)
        return self.x + (self.width if output else 0.0), self.y + _ROW * (2.8 + row)


def diagram_svg(diagram: Diagram) -> str:
    """Returns the drawing of a diagram and, below it, of each diagram inside it.

    Boxes stand in the direction of the data; dashed wires lead back and close a loop.
    Orange ports are those that the diagram offers to the outside. Systems with many ports,
    such as a plant, show those alone that are used.
    """
    parts: list[str] = []
    width, bottom = 0.0, 0.0
    for panel in [diagram, *(s for s in diagram.GetSystems() if isinstance(s, Diagram))]:
        parts.append(
            f'<text class="title" x="10" y="{bottom + 20:.0f}">{escape(_name(panel))}</text>'
        )
        right, bottom = _draw_panel(panel, bottom + 34, parts)
        width = max(width, right)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {bottom:.0f}" '
        f'width="{width:.0f}" height="{bottom:.0f}"><style>{_STYLE}</style>'
        '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(parts) + "\n</svg>\n"
    )


def _draw_panel(diagram: Diagram, top: float, parts: list[str]) -> tuple[float, float]:
    """Draws one diagram's systems; returns how far it reaches right and down."""
    systems = diagram.GetSystems()
    number = {system: i for i, system in enumerate(systems)}
    wires = sorted(
        (number[source], int(out), number[sink], int(inp))
        for (sink, inp), (source, out) in diagram.connection_map().items()
    )
    exported = _exported_ports(diagram, number)
    boxes = [_box(system, _ends(i, wires), exported[i]) for i, system in enumerate(systems)]
    layout = arrange(len(boxes), [(source, sink) for source, _, sink, _ in wires])
    right, depth = _place(boxes, layout.columns, top)
    for source, out, sink, inp in wires:
        start, end = boxes[source].port(out, output=True), boxes[sink].port(inp, output=False)
        back = (source, sink) in layout.backward
        depth += 5.0 if back else 0.0
        parts.append(_wire(start, end, _COLOURS[source % len(_COLOURS)], depth if back else None))
    parts.extend(_draw_box(box) for box in boxes)
    return right, depth + _GAP_Y


def _place(boxes: list[_Box], columns: list[list[int]], top: float) -> tuple[float, float]:
    """Sets the boxes' positions; returns how far they reach right and down."""
    x, bottom = 60.0, top
    for column in columns:
        y = top
        for i in column:
            boxes[i].x, boxes[i].y = x, y
            y += boxes[i].height + _GAP_Y
        bottom = max(bottom, y)
        x += max(boxes[i].width for i in column) + _GAP_X
    return x - _GAP_X + 40.0, bottom


def _ends(system: int, wires: list[tuple[int, int, int, int]]) -> set[tuple[bool, int]]:
    """The system's ports that wires end at, as (is output, index)."""
    outputs = {(True, out) for source, out, _, _ in wires if source == system}
    return outputs | {(False, inp) for _, _, sink, inp in wires if sink == system}


def _exported_ports(diagram: Diagram, number: dict[System, int]) -> list[set[tuple[bool, int]]]:
    exported: list[set[tuple[bool, int]]] = [set() for _ in number]
    for i in range(diagram.num_input_ports()):
        for system, port in diagram.GetInputPortLocators(InputPortIndex(i)):
            exported[number[system]].add((False, int(port)))
    for i in range(diagram.num_output_ports()):
        system, port = diagram.get_output_port_locator(OutputPortIndex(i))
        exported[number[system]].add((True, int(port)))
    return exported


def _box(system: System, wired: set[tuple[bool, int]], exported: set[tuple[bool, int]]) -> _Box:
    everything = system.num_input_ports() + system.num_output_ports() <= _MANY_PORTS
    used = wired | exported
    return _Box(
        name=_name(system),
        kind=type(system).__name__,
        inputs={
            i: system.get_input_port(i).get_name()
            for i in range(system.num_input_ports())
            if everything or (False, i) in used
        },
        outputs={
            i: system.get_output_port(i).get_name()
            for i in range(system.num_output_ports())
            if everything or (True, i) in used
        },
        exported=exported,
    )


def _name(system: System) -> str:
    """The system's name, unless Drake made it up from a memory address."""
    name: str = system.get_name()
    return type(system).__name__ if "@" in name else name


def _wire(
    start: tuple[float, float], end: tuple[float, float], colour: str, depth: float | None
) -> str:
    (x0, y0), (x1, y1) = start, end
    if depth is None:
        bend = max(40.0, (x1 - x0) / 2)
        path = (
            f"M{x0:.0f} {y0:.0f}C{x0 + bend:.0f} {y0:.0f} "
            f"{x1 - bend:.0f} {y1:.0f} {x1:.0f} {y1:.0f}"
        )
    else:
        path = (
            f"M{x0:.0f} {y0:.0f}C{x0 + 50:.0f} {y0:.0f} {x0 + 50:.0f} {depth:.0f} "
            f"{x0 - 20:.0f} {depth:.0f}L{x1 + 20:.0f} {depth:.0f}"
            f"C{x1 - 50:.0f} {depth:.0f} {x1 - 50:.0f} {y1:.0f} {x1:.0f} {y1:.0f}"
        )
    dash = "" if depth is None else ' stroke-dasharray="5 3"'
    return f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.3"{dash}/>'


def _draw_box(box: _Box) -> str:
    svg = (
        f'<rect class="box" x="{box.x:.0f}" y="{box.y:.0f}" rx="3" width="{box.width:.0f}" '
        f'height="{box.height:.0f}"/>'
        f'<text class="title" x="{box.x + 6:.0f}" y="{box.y + 14:.0f}">{escape(box.name)}</text>'
        f'<text x="{box.x + 6:.0f}" y="{box.y + 28:.0f}" fill="#666">{escape(box.kind)}</text>'
    )
    for output, names in ((False, box.inputs), (True, box.outputs)):
        for i, name in names.items():
            x, y = box.port(i, output)
            fill = "#e67700" if (output, i) in box.exported else "#333"
            anchor, shift = ("end", -6) if output else ("start", 6)
            svg += (
                f'<circle cx="{x:.0f}" cy="{y:.0f}" r="3" fill="{fill}"/><text x="{x + shift:.0f}" '
                f'y="{y + 4:.0f}" text-anchor="{anchor}">{escape(name)}</text>'
            )
    return svg
