"""The hand's boxes are those of the model."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from keypush.resources import models_dir
from keypush.robot.hand_shape import FINGERS, PALM, Box

TREE = ET.parse(models_dir() / "panda" / "panda.urdf")


@pytest.mark.parametrize(("name", "box"), [("palm", PALM), ("fingers", FINGERS)])
def test_boxes_are_those_of_the_model(name: str, box: Box) -> None:
    tool = TREE.find("frame[@name='panda_tool']")
    found = TREE.find(f"link[@name='panda_hand']/collision[@name='{name}']")
    assert tool is not None
    assert found is not None
    origin, shape = found.find("origin"), found.find("geometry/box")
    assert origin is not None
    assert shape is not None
    offset = np.array(origin.attrib["xyz"].split(), dtype=float)
    centre = offset - np.array(tool.attrib["xyz"].split(), dtype=float)
    np.testing.assert_allclose(box.centre, centre, atol=1e-12)
    np.testing.assert_allclose(box.size, np.array(shape.attrib["size"].split(), dtype=float))


def test_distance_is_that_of_the_nearest_point() -> None:
    box = Box((0.0, 0.0, 1.0), (2.0, 2.0, 2.0))
    assert box.distance(np.array([[0.5, 0.5, 0.5], [9.0, 9.0, 9.0]])) == 0.0
    assert box.distance(np.array([[4.0, 5.0, 1.0], [9.0, 9.0, 9.0]])) == pytest.approx(5.0)
