"""Drives, gravity, contact shapes and mistakes."""

import math

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Box, GeometryId, SceneGraph
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from keypush.errors import UserError
from keypush.robot.panda import Panda, add_panda, make_arm_plant
from keypush.scenario import RobotConfig, SimulationConfig
from tests.robot.panda_oracle import package_file

Q0 = np.array([0.0, -0.4, 0.0, -2.2, 0.0, 1.9, 0.785])


def build(
    time_step: float,
    simulation: SimulationConfig | None = None,
    target: np.ndarray | None = None,
) -> tuple[Diagram, MultibodyPlant, SceneGraph, Panda]:
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlant(MultibodyPlantConfig(time_step=time_step), builder)
    panda = add_panda(plant, RobotConfig(), simulation or SimulationConfig())
    plant.Finalize()
    if target is not None:
        source = builder.AddSystem(ConstantVectorSource(np.concatenate([target, np.zeros(7)])))
        builder.Connect(
            source.get_output_port(), plant.get_desired_state_input_port(panda.instance)
        )
    return builder.Build(), plant, scene_graph, panda


def shapes(scene_graph: SceneGraph) -> dict[str, GeometryId]:
    inspector = scene_graph.model_inspector()
    return {inspector.GetName(g).split("::")[-1]: g for g in inspector.GetAllGeometryIds()}


@pytest.mark.parametrize("time_step", [0.0, 0.001])
def test_actuators_follow_the_scenario(time_step: float) -> None:
    _, plant, _, panda = build(time_step)
    config = RobotConfig()
    indices = plant.GetJointActuatorIndices(panda.instance)
    actuators = [plant.get_joint_actuator(i) for i in indices]
    assert [a.joint().name() for a in actuators] == [f"panda_joint{i}" for i in range(1, 8)]
    assert [a.effort_limit() for a in actuators] == [87.0] * 4 + [12.0] * 3
    assert [a.default_reflected_inertia() for a in actuators] == config.reflected_inertia
    assert [float(*a.joint().default_damping_vector()) for a in actuators] == config.joint_damping
    for actuator in actuators:
        assert actuator.get_controller_gains().p == 200.0
        assert actuator.get_controller_gains().d == pytest.approx(math.sqrt(200.0))


def test_arm_without_torque_stays_put() -> None:
    diagram, plant, _, panda = build(0.001)
    simulator = Simulator(diagram)
    context = plant_context(plant, simulator)
    plant.SetPositions(context, panda.instance, Q0)
    simulator.AdvanceTo(0.2)
    assert not plant.is_gravity_enabled(panda.instance)
    np.testing.assert_allclose(plant.GetPositions(context, panda.instance), Q0, atol=1e-9)


def test_step_response_does_not_depend_on_the_time_step() -> None:
    # As far as one policy step of a push commands; implicit Euler errs in proportion to it.
    step = 0.03 * np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0])
    runs = []
    for time_step in (0.001, 0.005):
        diagram, plant, _, panda = build(time_step, target=Q0 + step)
        simulator = Simulator(diagram)
        context = plant_context(plant, simulator)
        plant.SetPositions(context, panda.instance, Q0)
        path = []
        for k in range(1, 11):
            simulator.AdvanceTo(0.1 * k)
            path.append(plant.GetPositions(context, panda.instance))
        runs.append(np.array(path))
    np.testing.assert_allclose(runs[0][-1], Q0 + step, atol=2e-3)
    assert np.abs(runs[0] - runs[1]).max() < 1e-3


def test_only_hand_and_forearm_have_shapes_and_none_collide_with_each_other() -> None:
    _, _, scene_graph, _ = build(0.0)
    assert set(shapes(scene_graph)) == {"forearm", "wrist_pitch", "wrist_roll", "palm", "fingers"}
    assert scene_graph.model_inspector().GetCollisionCandidates() == set()


def test_arm_collision_can_be_left_out() -> None:
    _, _, scene_graph, _ = build(0.0, SimulationConfig(arm_collision=False))
    assert set(shapes(scene_graph)) == {"palm", "fingers"}


def test_shapes_are_compliant_with_the_scenarios_material() -> None:
    simulation = SimulationConfig(hydroelastic_modulus=3e6, dissipation=20.0)
    _, _, scene_graph, _ = build(0.0, simulation)
    inspector = scene_graph.model_inspector()
    for geometry in shapes(scene_graph).values():
        properties = inspector.GetProximityProperties(geometry)
        assert properties is not None
        assert properties.GetProperty("hydroelastic", "hydroelastic_modulus") == 3e6
        assert properties.GetProperty("material", "hunt_crossley_dissipation") == 20.0
        friction = properties.GetProperty("material", "coulomb_friction")
        assert isinstance(friction, CoulombFriction)
        assert friction.dynamic_friction() == RobotConfig().gripper_friction


def test_closed_fingers_end_where_the_real_ones_end() -> None:
    _, _, scene_graph, panda = build(0.0)
    inspector = scene_graph.model_inspector()
    fingers = shapes(scene_graph)["fingers"]
    box = inspector.GetShape(fingers)
    assert isinstance(box, Box)
    z_tip = inspector.GetPoseInFrame(fingers).translation()[2] + box.height() / 2
    real = trimesh.load_mesh(package_file("meshes/collision/finger.stl"))
    assert z_tip == pytest.approx(0.0584 + real.bounds[1, 2], abs=1e-3)
    # E is the middle of the finger pads, 9 mm short of the tip.
    z_tool = panda.tool_frame.GetFixedPoseInBodyFrame().translation()[2]
    assert z_tool == pytest.approx(0.1034)
    assert 0.008 < z_tip - z_tool < 0.010


def test_kinematics_plant_has_no_geometry() -> None:
    plant, panda = make_arm_plant(RobotConfig())
    assert plant.num_positions() == plant.num_velocities() == 7
    assert not plant.geometry_source_is_registered()
    assert panda.tool_frame.body().name() == "panda_hand"


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (RobotConfig(stiffness=math.nan), "robot.stiffness is nan"),
        (RobotConfig(joint_damping=[1.0] * 6), "robot.joint_damping has 6 entries; allowed: 7"),
        (RobotConfig(reflected_inertia=[-1.0] * 7), "robot.reflected_inertia is -1"),
    ],
)
def test_bad_configuration_is_named(config: RobotConfig, message: str) -> None:
    with pytest.raises(UserError, match=message):
        add_panda(MultibodyPlant(0.0), config, SimulationConfig())


def plant_context(plant: MultibodyPlant, simulator: Simulator) -> Context:
    return plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
