"""The Panda's URDF with the scenario's contact materials written into it."""

import math
import xml.etree.ElementTree as ET

from keypush.resources import models_dir
from keypush.scenario import RobotConfig, Scenario, SimulationConfig

_DRAKE = "{http://drake.mit.edu}"
_ARM_SHAPES = ("forearm", "wrist_pitch", "wrist_roll")


def panda_urdf(config: RobotConfig, simulation: SimulationConfig) -> str:
    """Returns the URDF text of `models/panda` with contact materials filled in.

    Every collision shape becomes compliant hydroelastic. Without
    `simulation.arm_collision` only palm and fingers keep theirs.

    Raises:
        UserError: a field of either configuration is out of range.
    """
    Scenario(robot=config, simulation=simulation).validate()
    ET.register_namespace("drake", _DRAKE.strip("{}"))
    root = ET.parse(models_dir() / "panda" / "panda.urdf").getroot()
    for link in root.iter("link"):
        for collision in link.findall("collision"):
            if not simulation.arm_collision and collision.get("name") in _ARM_SHAPES:
                link.remove(collision)
            else:
                collision.append(_proximity(config, simulation))
    return ET.tostring(root, encoding="unicode")


def joint_gains(config: RobotConfig) -> tuple[float, float]:
    """Returns (k_p in Nm/rad, k_d in Nms/rad) of every joint; k_d = rho sqrt(k_p)."""
    return config.stiffness, config.damping_ratio * math.sqrt(config.stiffness)


def _proximity(config: RobotConfig, simulation: SimulationConfig) -> ET.Element:
    properties = ET.Element(f"{_DRAKE}proximity_properties")
    ET.SubElement(properties, f"{_DRAKE}compliant_hydroelastic")
    for name, value in (
        ("hydroelastic_modulus", simulation.hydroelastic_modulus),
        ("hunt_crossley_dissipation", simulation.dissipation),
        ("mu_static", config.gripper_friction),
        ("mu_dynamic", config.gripper_friction),
        ("mesh_resolution_hint", 0.02),
    ):
        ET.SubElement(properties, f"{_DRAKE}{name}", value=repr(float(value)))
    return properties
