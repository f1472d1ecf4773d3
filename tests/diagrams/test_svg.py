"""The diagram's drawing is an SVG that names every system and every wired port."""

import xml.etree.ElementTree as ET

from pydrake.systems.framework import Diagram

from diagrams.push_diagram import MakePushDiagram
from diagrams.svg import diagram_svg
from keypush.learning.baselines import CentroidKeypoint
from keypush.scenario import Scenario

SVG = "{http://www.w3.org/2000/svg}"


def _panels() -> list[Diagram]:
    push = MakePushDiagram(Scenario(policy="centroid"), CentroidKeypoint())
    return [push.diagram, push.station.diagram]


def test_every_system_and_every_wire_is_drawn() -> None:
    panels = _panels()
    root = ET.fromstring(diagram_svg(panels[0]))
    assert root.tag == f"{SVG}svg"
    texts = [text.text for text in root.iter(f"{SVG}text")]
    wires = 0
    for panel in panels:
        assert panel.get_name() in texts
        for system in panel.GetSystems():
            assert system.get_name() in texts
        for (sink, i), (source, o) in panel.connection_map().items():
            wires += 1
            assert sink.get_input_port(int(i)).get_name() in texts
            assert source.get_output_port(int(o)).get_name() in texts
    assert len(list(root.iter(f"{SVG}path"))) >= wires


def test_everything_lies_on_the_page() -> None:
    root = ET.fromstring(diagram_svg(_panels()[0]))
    _, _, width, height = map(float, root.attrib["viewBox"].split())
    for box in root.iter(f"{SVG}rect"):
        if "x" in box.attrib:
            assert 0 <= float(box.attrib["x"]) <= width - float(box.attrib["width"])
            assert 0 <= float(box.attrib["y"]) <= height - float(box.attrib["height"])


def test_the_drawing_repeats_itself() -> None:
    first, second = (diagram_svg(_panels()[0]) for _ in range(2))
    assert first == second
