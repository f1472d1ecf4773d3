"""The Panda of the package example-robot-data: same published robot, written by others."""

import xml.etree.ElementTree as ET
from importlib.metadata import files
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant


def package_file(name: str) -> Path:
    """Returns the path of a file of `panda_description`, such as `urdf/panda.urdf`."""
    (found,) = (
        file
        for file in files("example-robot-data") or []
        if file.as_posix().endswith(f"panda_description/{name}")
    )
    return Path(str(found.locate()))


def oracle_plant(base: list[float]) -> MultibodyPlant:
    """Returns the finalized plant, welded at `base` (m, in W): 7 joints and 2 fingers."""
    root = ET.parse(package_file("urdf/panda.urdf")).getroot()
    for link in root.iter("link"):
        for shape in link.findall("visual") + link.findall("collision"):
            link.remove(shape)
    weld = ET.fromstring(
        '<joint name="base" type="fixed"><parent link="world"/><child link="panda_link0"/>'
        f'<origin xyz="{base[0]} {base[1]} {base[2]}"/></joint>'
    )
    root.append(weld)
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModelsFromString(ET.tostring(root, encoding="unicode"), "urdf")
    plant.Finalize()
    return plant
