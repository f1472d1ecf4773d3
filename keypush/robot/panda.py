"""The Panda arm with closed fingers, added to a plant as the scenario describes it."""

from dataclasses import dataclass
from typing import cast

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    Frame,
    ModelInstanceIndex,
    PdControllerGains,
    RevoluteJoint,
    RigidBody,
)

from keypush.robot.description import joint_gains, panda_urdf
from keypush.scenario import RobotConfig, SimulationConfig

NUM_JOINTS = 7


@dataclass(frozen=True)
class Panda:
    """Where the arm is found in its plant; valid as long as the plant lives."""

    instance: ModelInstanceIndex
    """Model instance of the whole arm: 7 positions, 7 velocities, 7 actuators."""
    tool_body: RigidBody
    """The hand; it carries palm and closed fingers."""
    tool_frame: Frame
    """E: 0.1034 m beyond the hand along its z, in the middle of the closed finger pads."""


def add_panda(plant: MultibodyPlant, config: RobotConfig, simulation: SimulationConfig) -> Panda:
    """Adds the arm to a plant that is not finalized, continuous or discrete.

    The base is welded at `config.base_position`, gravity does not act on the arm, the joint
    actuators carry implicit PD gains and the effort limits 87 and 12 Nm. Feed positions and
    velocities to `plant.get_desired_state_input_port(panda.instance)`, (14,), and torques to
    `plant.get_actuation_input_port(panda.instance)`, (7,). Geometry is added only when the
    plant is a source for a SceneGraph; no two shapes of the arm collide with each other.

    Raises:
        UserError: a field of either configuration is out of range.
    """
    (instance,) = Parser(plant).AddModelsFromString(panda_urdf(config, simulation), "urdf")
    base = plant.GetBodyByName("panda_link0", instance)
    plant.WeldFrames(
        plant.world_frame(), base.body_frame(), RigidTransform(np.array(config.base_position))
    )
    plant.set_gravity_enabled(instance, False)
    stiffness, damping = joint_gains(config)
    gains = PdControllerGains(p=stiffness, d=damping)
    for i in range(NUM_JOINTS):
        name = f"panda_joint{i + 1}"
        joint = cast(RevoluteJoint, plant.GetJointByName(name, instance))
        joint.set_default_damping(config.joint_damping[i])
        actuator = plant.GetJointActuatorByName(name, instance)
        # With gear ratio 1 the rotor inertia is the reflected inertia.
        actuator.set_default_gear_ratio(1.0)
        actuator.set_default_rotor_inertia(config.reflected_inertia[i])
        actuator.set_controller_gains(gains)
    return Panda(
        instance=instance,
        tool_body=plant.GetBodyByName("panda_hand", instance),
        tool_frame=plant.GetFrameByName("panda_tool", instance),
    )


def make_arm_plant(config: RobotConfig) -> tuple[MultibodyPlant, Panda]:
    """Returns a finalized continuous plant of the arm alone, for kinematics and Jacobians.

    It has no geometry, 7 positions and 7 velocities. Joint limits are the plant's
    `GetPositionLowerLimits()`, `GetVelocityUpperLimits()` and their like.

    Raises:
        UserError: a field of the configuration is out of range.
    """
    plant = MultibodyPlant(time_step=0.0)
    panda = add_panda(plant, config, SimulationConfig())
    plant.Finalize()
    return plant, panda
