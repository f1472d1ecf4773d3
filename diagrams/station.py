"""MakePushStation: arm, table, object, sensors and controller in one diagram."""

from dataclasses import dataclass

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Diagram, DiagramBuilder

from keypush.control.arm_kinematics import ArmKinematics
from keypush.objects.model import ObjectModel
from keypush.objects.plant import add_object
from keypush.objects.point_cloud import sensed_points
from keypush.objects.table import add_table
from keypush.robot.panda import NUM_JOINTS, Panda, add_panda
from keypush.robot.visuals import add_panda_visuals
from keypush.scenario import Scenario, SimulationConfig
from keypush.systems.contact_sensor import ContactSensor
from keypush.systems.differential_ik_controller import DifferentialIkController
from keypush.systems.point_cloud_sensor import PointCloudSensor
from keypush.systems.station_poses import StationPoses
from keypush.systems.torque_noise import TorqueNoise


@dataclass(frozen=True)
class PushStation:
    """The station's diagram and the parts that are set up anew for every episode."""

    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    panda: Panda
    object_body: RigidBody
    model: ObjectModel
    poses: StationPoses
    point_cloud_sensor: PointCloudSensor
    torque_noise: TorqueNoise


def MakePushStation(scenario: Scenario, model: ObjectModel, visuals: bool = False) -> PushStation:
    """Builds the station that every policy shares.

    Input port: `tool_action` (6). Output ports: `arm_state` (14), `tool_pose`,
    `object_pose` and `object_com` (ground truth), `point_cloud` (3 N), `contact` (6),
    `query_object`; see the systems for frames and units.

    Args:
        scenario: all constants.
        model: the object on the table.
        visuals: whether the robot gets its visual meshes, for a recording.
    """
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlant(_plant_config(scenario.simulation), builder)
    plant.set_name("plant")
    add_table(plant, scenario.table, scenario.simulation)
    panda = add_panda(plant, scenario.robot, scenario.simulation)
    if visuals:
        add_panda_visuals(plant, panda)
    body = add_object(plant, model, scenario.object.friction)
    plant.Finalize()

    poses = _add_poses(builder, plant, panda, body, model)
    sensor = _add_point_cloud_sensor(builder, poses, scenario, model)
    noise = _add_control(builder, plant, panda, scenario)
    contact = builder.AddSystem(_contact_sensor(plant, panda, body))
    builder.Connect(
        plant.get_contact_results_output_port(), contact.GetInputPort("contact_results")
    )
    builder.ExportOutput(plant.get_state_output_port(panda.instance), "arm_state")
    for name in ("tool_pose", "object_pose", "object_com"):
        builder.ExportOutput(poses.GetOutputPort(name), name)
    builder.ExportOutput(sensor.GetOutputPort("point_cloud"), "point_cloud")
    builder.ExportOutput(contact.GetOutputPort("contact"), "contact")
    builder.ExportOutput(scene_graph.get_query_output_port(), "query_object")
    diagram = builder.Build()
    diagram.set_name("station")
    return PushStation(diagram, plant, scene_graph, panda, body, model, poses, sensor, noise)


def _plant_config(config: SimulationConfig) -> MultibodyPlantConfig:
    discrete = config.integrator == "discrete"
    return MultibodyPlantConfig(
        time_step=config.discrete_period if discrete else 0.0,
        contact_model="hydroelastic_with_fallback",
        discrete_contact_approximation="lagged" if discrete else "",
    )


def _add_poses(
    builder: DiagramBuilder,
    plant: MultibodyPlant,
    panda: Panda,
    body: RigidBody,
    model: ObjectModel,
) -> StationPoses:
    X_HE = panda.tool_frame.GetFixedPoseInBodyFrame()
    poses = StationPoses(body.index(), panda.tool_body.index(), X_HE, model.p_OoOcm_O)
    builder.AddSystem(poses)
    builder.Connect(plant.get_body_poses_output_port(), poses.GetInputPort("body_poses"))
    return poses


def _add_point_cloud_sensor(
    builder: DiagramBuilder, poses: StationPoses, scenario: Scenario, model: ObjectModel
) -> PointCloudSensor:
    p_OP = sensed_points(model, scenario.noise.cloud_points, scenario.seed)
    period = scenario.episode.policy_period
    sensor = PointCloudSensor(p_OP, scenario.noise.cloud_deviation, period)
    builder.AddSystem(sensor)
    builder.Connect(poses.GetOutputPort("object_pose"), sensor.GetInputPort("object_pose"))
    return sensor


def _add_control(
    builder: DiagramBuilder, plant: MultibodyPlant, panda: Panda, scenario: Scenario
) -> TorqueNoise:
    period = scenario.episode.policy_period
    arm = ArmKinematics(scenario.robot)
    controller = builder.AddSystem(DifferentialIkController(arm, scenario.control, period))
    noise = TorqueNoise(NUM_JOINTS, scenario.noise.torque_deviation, period)
    builder.AddSystem(noise)
    builder.Connect(
        plant.get_state_output_port(panda.instance), controller.GetInputPort("arm_state")
    )
    builder.Connect(
        controller.GetOutputPort("arm_desired_state"),
        plant.get_desired_state_input_port(panda.instance),
    )
    builder.Connect(noise.GetOutputPort("torque"), plant.get_actuation_input_port(panda.instance))
    builder.ExportInput(controller.GetInputPort("tool_action"), "tool_action")
    return noise


def _contact_sensor(plant: MultibodyPlant, panda: Panda, body: RigidBody) -> ContactSensor:
    bodies = [plant.get_body(index) for index in plant.GetBodyIndices(panda.instance)]
    robot = {g for b in bodies for g in plant.GetCollisionGeometriesForBody(b)}
    return ContactSensor(
        robot_geometries=frozenset(robot),
        object_geometries=frozenset(plant.GetCollisionGeometriesForBody(body)),
        robot_bodies=frozenset(b.index() for b in bodies),
        object_body=body.index(),
    )
