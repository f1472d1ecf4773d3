"""The station's scene as a MuJoCo model, built from the same description and scenario."""

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
from pydrake.math import RollPitchYaw

from keypush.bench.convex_pieces import convex_pieces
from keypush.bench.development_package import import_development
from keypush.objects.model import ObjectModel
from keypush.objects.table import FLOOR, THICKNESS
from keypush.robot.description import joint_gains, panda_urdf
from keypush.scenario import Scenario

TIME_STEP = 0.002
"""MuJoCo's time step, s."""
OBJECT = "object"
TOOL = "panda_tool"
_CAPSULE = "{http://drake.mit.edu}capsule"


def make_mujoco_model(scenario: Scenario, model: ObjectModel) -> Any:
    """Builds the `MjModel` of arm, table, floor and object.

    Arm: kinematics, inertias, limits and primitives of `models/panda`, PD gains as position
    actuators, gravity compensated. Object: convex pieces, same mass, COM and inertia. The
    pairs that may touch are listed, each with Drake's combination of friction, 2ab/(a+b).
    The integrator is implicitfast; all else is as MuJoCo has it.

    Raises:
        UserError: MuJoCo or CoACD is not installed.
    """
    mj = import_development("mujoco")
    spec = mj.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = TIME_STEP
    spec.option.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
    groups = {
        "table": _add_table(mj, spec, scenario),
        "robot": _add_arm(mj, spec, scenario),
        "object": _add_object(mj, spec, model),
    }
    friction = {
        "table": scenario.table.friction,
        "robot": scenario.robot.gripper_friction,
        "object": scenario.object.friction,
    }
    for a, b in (("object", "table"), ("object", "robot"), ("robot", "table")):
        sliding = _combined_friction(friction[a], friction[b])
        for first in groups[a]:
            for second in groups[b]:
                spec.add_pair(
                    geomname1=first, geomname2=second, friction=[sliding, sliding, 0, 0, 0]
                )
    return spec.compile()


def _combined_friction(a: float, b: float) -> float:
    return 2 * a * b / (a + b) if a + b > 0 else 0.0


def _add_table(mj: Any, spec: Any, scenario: Scenario) -> list[str]:
    table = scenario.table
    top = [table.length / 2, table.width / 2, THICKNESS / 2]
    floor = [extent / 2 for extent in FLOOR]
    _add_box(mj, spec.worldbody, "table_top", top, [0, 0, -THICKNESS / 2])
    _add_box(mj, spec.worldbody, "floor", floor, [0, 0, -table.height - FLOOR[2] / 2])
    return ["table_top", "floor"]


def _add_box(mj: Any, body: Any, name: str, half: list[float], position: list[float]) -> None:
    body.add_geom(name=name, type=mj.mjtGeom.mjGEOM_BOX, size=half, pos=position, **_ONLY_PAIRS)


_ONLY_PAIRS = {"contype": 0, "conaffinity": 0}


def _add_object(mj: Any, spec: Any, model: ObjectModel) -> list[str]:
    body = spec.worldbody.add_body(name=OBJECT, pos=[0, 0, model.rest_height])
    body.add_freejoint(name=OBJECT)
    inertia = model.I_OOcm_O
    _set_inertia(body, model.mass, model.p_OoOcm_O.tolist(), inertia)
    names = []
    for i, piece in enumerate(convex_pieces(model)):
        name = f"{OBJECT}_{i}"
        spec.add_mesh(name=name, uservert=piece.ravel())
        body.add_geom(name=name, type=mj.mjtGeom.mjGEOM_MESH, meshname=name, **_ONLY_PAIRS)
        names.append(name)
    return names


def _set_inertia(body: Any, mass: float, com: list[float], inertia: Any) -> None:
    body.explicitinertial = True
    body.mass = mass
    body.ipos = com
    body.fullinertia = [inertia[i][j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def _add_arm(mj: Any, spec: Any, scenario: Scenario) -> list[str]:
    """Adds links in the URDF's order, which has parents before their children."""
    root = ET.fromstring(panda_urdf(scenario.robot, scenario.simulation))
    links = {link.get("name", ""): link for link in root.findall("link")}
    base = spec.worldbody.add_body(name="panda_link0", pos=scenario.robot.base_position)
    bodies = {"panda_link0": base}
    names = _fill_link(mj, base, links["panda_link0"])
    moving = 0
    for joint in root.findall("joint"):
        child = _found(joint, "child").get("link", "")
        parent = bodies[_found(joint, "parent").get("link", "")]
        bodies[child] = parent.add_body(name=child, gravcomp=1.0, **_pose(joint))
        names += _fill_link(mj, bodies[child], links[child])
        if joint.get("type") == "revolute":
            _add_joint(mj, spec, bodies[child], joint, scenario, moving)
            moving += 1
    for frame in root.findall("frame"):
        body = bodies[frame.get("link", "")]
        body.add_site(name=frame.get("name", ""), pos=_numbers(frame, "xyz"))
    return names


def _fill_link(mj: Any, body: Any, link: ET.Element) -> list[str]:
    inertial = _found(link, "inertial")
    entries = _found(inertial, "inertia")
    i = {name: float(entries.get(name, "")) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
    matrix = [
        [i["ixx"], i["ixy"], i["ixz"]],
        [i["ixy"], i["iyy"], i["iyz"]],
        [i["ixz"], i["iyz"], i["izz"]],
    ]
    mass = float(_found(inertial, "mass").get("value", ""))
    _set_inertia(body, mass, _numbers(_found(inertial, "origin"), "xyz"), matrix)
    names = []
    for collision in link.findall("collision"):
        (shape,) = _found(collision, "geometry")
        if shape.tag == _CAPSULE:
            kind = mj.mjtGeom.mjGEOM_CAPSULE
            size = [float(shape.get("radius", "")), float(shape.get("length", "")) / 2, 0.0]
        else:
            kind = mj.mjtGeom.mjGEOM_BOX
            size = [extent / 2 for extent in _numbers(shape, "size")]
        name = collision.get("name", "")
        body.add_geom(name=name, type=kind, size=size, **_pose(collision), **_ONLY_PAIRS)
        names.append(name)
    return names


def _add_joint(
    mj: Any, spec: Any, body: Any, joint: ET.Element, scenario: Scenario, index: int
) -> None:
    limit, name = _found(joint, "limit"), joint.get("name", "")
    body.add_joint(
        name=name,
        axis=_numbers(_found(joint, "axis"), "xyz"),
        range=[float(limit.get("lower", "")), float(limit.get("upper", ""))],
        limited=mj.mjtLimited.mjLIMITED_TRUE,
        damping=scenario.robot.joint_damping[index],
        armature=scenario.robot.reflected_inertia[index],
    )
    stiffness, damping = joint_gains(scenario.robot)
    effort = float(limit.get("effort", ""))
    actuator = spec.add_actuator(name=name, target=name, trntype=mj.mjtTrn.mjTRN_JOINT)
    actuator.set_to_position(kp=stiffness, kv=damping)
    actuator.forcelimited = mj.mjtLimited.mjLIMITED_TRUE
    actuator.forcerange = [-effort, effort]


def _pose(element: ET.Element) -> dict[str, Any]:
    origin = _found(element, "origin")
    rpy = RollPitchYaw(np.array(_numbers(origin, "rpy")))
    return {"pos": _numbers(origin, "xyz"), "quat": rpy.ToQuaternion().wxyz()}


def _numbers(element: ET.Element, name: str) -> list[float]:
    return [float(number) for number in element.get(name, "").split()]


def _found(element: ET.Element, tag: str) -> ET.Element:
    found = element.find(tag)
    assert found is not None, f"models/panda/panda.urdf: <{element.tag}> has no <{tag}>"
    return found
