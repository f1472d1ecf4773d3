"""MakePushDiagram: the station, the policy that drives it, the monitor and the logger."""

from dataclasses import dataclass

from pydrake.geometry import Meshcat, MeshcatVisualizer
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, LogVectorOutput, VectorLogSink

from diagrams.episode_parts import add_goal_and_monitor, add_push_planner, add_visualizer, connect
from diagrams.station import MakePushStation, PushStation
from keypush.control.arm_kinematics import ArmKinematics
from keypush.learning.model import ActionModel, KeypointModel, PolicyModel
from keypush.objects.library import make_object
from keypush.objects.model import ObjectModel
from keypush.policies import find_policy
from keypush.scenario import Scenario
from keypush.seeding import make_generator
from keypush.systems.behavior_cloning_policy import BehaviorCloningPolicy
from keypush.systems.episode_logger import EpisodeLogger
from keypush.systems.episode_monitor import EpisodeMonitor
from keypush.systems.expert_planner import ExpertPlanner
from keypush.systems.keypoint_predictor import KeypointPredictor
from keypush.systems.push_planner import PushPlanner
from keypush.systems.scene_system import SceneSystem

Driver = ExpertPlanner | PushPlanner | BehaviorCloningPolicy
"""What drives the port `tool_action`."""
_EXPERT_POINTS = 2000
"""Surface points that stand for the object's geometry in the expert."""


@dataclass(frozen=True)
class PushPolicy:
    """The systems that `add_policy` adds."""

    goal: ConstantVectorSource
    planner: Driver
    monitor: EpisodeMonitor
    log: VectorLogSink


@dataclass(frozen=True)
class PushDiagram(PushPolicy):
    """A whole episode's diagram; one per object, reset between episodes."""

    diagram: Diagram
    station: PushStation
    visualizer: MeshcatVisualizer | None


def MakePushDiagram(
    scenario: Scenario,
    policy_model: PolicyModel | None = None,
    meshcat: Meshcat | None = None,
) -> PushDiagram:
    """Wires station, policy, monitor and logger.

    Args:
        scenario: all constants; `scenario.policy` says who drives.
        policy_model: what the policy asks (see `keypush.learning.policy_model`); the expert
            needs none.
        meshcat: where to show the scene; the robot then has its visual meshes. It is
            drawn once per policy step, so that watching does not change the simulation.
    """
    model = make_object(scenario.object.name, scenario.object.size_ratio, scenario.object.mass)
    builder = DiagramBuilder()
    station = MakePushStation(scenario, model, visuals=meshcat is not None)
    builder.AddSystem(station.diagram)
    policy = add_policy(builder, station.diagram, model, scenario, policy_model)
    visualizer = add_visualizer(builder, station.diagram, scenario, meshcat)
    diagram = builder.Build()
    diagram.set_name("push")
    return PushDiagram(**vars(policy), diagram=diagram, station=station, visualizer=visualizer)


def add_policy(
    builder: DiagramBuilder,
    station: Diagram,
    model: ObjectModel,
    scenario: Scenario,
    policy_model: PolicyModel | None = None,
) -> PushPolicy:
    """Adds goal, policy, monitor and logger, and closes the loop around a station.

    Args:
        builder: holds the station.
        station: has the ports of `MakePushStation`'s that the policy needs.
        model: the object on the table.
        scenario: all constants; `scenario.policy` says who drives.
        policy_model: see `MakePushDiagram`.
    """
    goal, monitor = add_goal_and_monitor(builder, station, model, scenario)
    planner: Driver
    if scenario.policy == "expert":
        planner = _add_expert(builder, station, model, goal, scenario)
    else:
        assert policy_model is not None, f"policy {scenario.policy} needs a model"
        if find_policy(scenario.policy).acts:
            planner = _add_behavior_cloning(builder, station, goal, scenario, policy_model)
        else:
            planner = _add_keypoint_policy(builder, station, goal, scenario, policy_model)
    connect(builder, monitor, planner, ["halted"])
    connect(builder, planner, station, ["tool_action"])
    log = _add_logger(builder, station, goal, planner, scenario.episode.policy_period)
    return PushPolicy(goal, planner, monitor, log)


def _add_expert(
    builder: DiagramBuilder,
    station: Diagram,
    model: ObjectModel,
    goal: ConstantVectorSource,
    scenario: Scenario,
) -> ExpertPlanner:
    points = model.surface_points(_EXPERT_POINTS, make_generator(0, 0, "expert_points"))
    planner = ExpertPlanner(
        points,
        ArmKinematics(scenario.robot),
        scenario.planner,
        scenario.control,
        scenario.table,
        scenario.episode.policy_period,
    )
    builder.AddSystem(planner)
    connect(builder, station, planner, ["object_pose", "object_com", "tool_pose", "arm_state"])
    builder.Connect(goal.get_output_port(), planner.GetInputPort("goal"))
    return planner


def _add_keypoint_policy(
    builder: DiagramBuilder,
    station: Diagram,
    goal: ConstantVectorSource,
    scenario: Scenario,
    model: KeypointModel,
) -> PushPlanner:
    period = scenario.episode.policy_period
    predictor = KeypointPredictor(model, scenario.noise.cloud_points, period)
    builder.AddSystem(predictor)
    _connect_scene(builder, station, goal, predictor, model)
    planner = add_push_planner(builder, station, goal, scenario)
    connect(builder, predictor, planner, ["keypoint"])
    return planner


def _add_behavior_cloning(
    builder: DiagramBuilder,
    station: Diagram,
    goal: ConstantVectorSource,
    scenario: Scenario,
    model: ActionModel,
) -> BehaviorCloningPolicy:
    points, period = scenario.noise.cloud_points, scenario.episode.policy_period
    policy = BehaviorCloningPolicy(model, points, scenario.control, period)
    builder.AddSystem(policy)
    _connect_scene(builder, station, goal, policy, model)
    return policy


def _connect_scene(
    builder: DiagramBuilder,
    station: Diagram,
    goal: ConstantVectorSource,
    system: SceneSystem,
    model: PolicyModel,
) -> None:
    """Connects what a model may see."""
    seen = ["point_cloud", "tool_pose"]
    connect(builder, station, system, [*seen, "object_com"] if model.uses_com else seen)
    builder.Connect(goal.get_output_port(), system.GetInputPort("goal"))


def _add_logger(
    builder: DiagramBuilder,
    station: Diagram,
    goal: ConstantVectorSource,
    planner: Driver,
    period: float,
) -> VectorLogSink:
    logger = builder.AddSystem(EpisodeLogger())
    connect(
        builder,
        station,
        logger,
        ["object_pose", "object_com", "tool_pose", "arm_state", "contact"],
    )
    connect(builder, planner, logger, ["stage", "tool_action", "contact_target"])
    builder.Connect(goal.get_output_port(), logger.GetInputPort("goal"))
    log = LogVectorOutput(logger.GetOutputPort("row"), builder, publish_period=period)
    log.set_name("episode_log")
    return log
