"""What the diagrams of an episode share, whoever drives the tool."""

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.systems.framework import Diagram, DiagramBuilder, System
from pydrake.systems.primitives import ConstantVectorSource

from keypush.control.arm_kinematics import ArmKinematics
from keypush.objects.model import ObjectModel
from keypush.scenario import Scenario
from keypush.systems.episode_monitor import EpisodeMonitor
from keypush.systems.push_planner import PushPlanner
from keypush.systems.upright_estimator import UprightEstimator


def connect(builder: DiagramBuilder, source: System, sink: System, names: list[str]) -> None:
    """Connects ports that have the same name on both sides."""
    for name in names:
        builder.Connect(source.GetOutputPort(name), sink.GetInputPort(name))


def add_goal_and_monitor(
    builder: DiagramBuilder, station: Diagram, model: ObjectModel, scenario: Scenario
) -> tuple[ConstantVectorSource, EpisodeMonitor]:
    """Adds where the object is to go, and who judges whether it got there."""
    goal = ConstantVectorSource(np.zeros(2))
    goal.set_name("goal")
    monitor = EpisodeMonitor(model.reference_points, scenario.episode, scenario.table)
    builder.AddSystem(goal)
    builder.AddSystem(monitor)
    connect(builder, station, monitor, ["object_pose", "object_com", "tool_pose"])
    builder.Connect(goal.get_output_port(), monitor.GetInputPort("goal"))
    return goal, monitor


def add_push_planner(
    builder: DiagramBuilder, station: Diagram, goal: ConstantVectorSource, scenario: Scenario
) -> PushPlanner:
    """Adds a planner that pushes at a keypoint, whose port is left open.

    It gives way to an object that tilts, as the expert does, as far as the noisy cloud tells.
    """
    arm, period = ArmKinematics(scenario.robot), scenario.episode.policy_period
    planner = PushPlanner(arm, scenario.planner, scenario.control, scenario.table, period)
    upright = UprightEstimator(scenario.noise.cloud_points, period)
    builder.AddSystem(planner)
    builder.AddSystem(upright)
    connect(builder, station, upright, ["point_cloud"])
    connect(builder, upright, planner, ["object_up"])
    connect(builder, station, planner, ["tool_pose", "arm_state"])
    builder.Connect(goal.get_output_port(), planner.GetInputPort("goal"))
    return planner


def add_visualizer(
    builder: DiagramBuilder, station: Diagram, scenario: Scenario, meshcat: Meshcat | None
) -> MeshcatVisualizer | None:
    """Adds what draws the scene once per policy step; nothing without a Meshcat."""
    if meshcat is None:
        return None
    return MeshcatVisualizer.AddToBuilder(
        builder,
        station.GetOutputPort("query_object"),
        meshcat,
        MeshcatVisualizerParams(publish_period=scenario.episode.policy_period),
    )
