"""MakeOpenPushDiagram: the station and the monitor, with an input port where a policy acts."""

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from diagrams.station import MakePushStation, PushStation
from keypush.control.arm_kinematics import ArmKinematics
from keypush.objects.library import make_object
from keypush.scenario import Scenario
from keypush.systems.episode_monitor import EpisodeMonitor
from keypush.systems.push_planner import PushPlanner

OPEN_PORTS = ("tool_action", "keypoint")
"""Input ports that a diagram may have."""


@dataclass(frozen=True)
class OpenPushDiagram:
    """The diagram of an episode that is driven from outside; one per object."""

    diagram: Diagram
    station: PushStation
    goal: ConstantVectorSource
    monitor: EpisodeMonitor
    planner: PushPlanner | None
    """None where the tool itself is driven."""
    visualizer: MeshcatVisualizer | None


def MakeOpenPushDiagram(
    scenario: Scenario, port: str, meshcat: Meshcat | None = None
) -> OpenPushDiagram:
    """Wires station, goal and monitor, and exports one input port, read once per policy step.

    Args:
        scenario: all constants; its policy is not looked at.
        port: `tool_action` (6), the residual of the tool pose, or `keypoint` (3), at which a
            `PushPlanner` pushes; see there for frames and units.
        meshcat: where to show the scene, as in `MakePushDiagram`.
    """
    assert port in OPEN_PORTS
    model = make_object(scenario.object.name, scenario.object.size_ratio, scenario.object.mass)
    builder = DiagramBuilder()
    station = MakePushStation(scenario, model, visuals=meshcat is not None)
    builder.AddSystem(station.diagram)
    goal = ConstantVectorSource(np.zeros(2))
    goal.set_name("goal")
    builder.AddSystem(goal)
    monitor = _add_monitor(builder, station, goal, scenario)
    tool_action, planner = station.diagram.GetInputPort("tool_action"), None
    if port == "keypoint":
        planner = _add_planner(builder, station, goal, monitor, scenario)
        builder.Connect(planner.GetOutputPort("tool_action"), tool_action)
        builder.ExportInput(planner.GetInputPort("keypoint"), port)
    else:
        builder.ExportInput(tool_action, port)
    visualizer = None
    if meshcat is not None:
        visualizer = MeshcatVisualizer.AddToBuilder(
            builder,
            station.diagram.GetOutputPort("query_object"),
            meshcat,
            MeshcatVisualizerParams(publish_period=scenario.episode.policy_period),
        )
    diagram = builder.Build()
    diagram.set_name("open_push")
    return OpenPushDiagram(diagram, station, goal, monitor, planner, visualizer)


def _add_monitor(
    builder: DiagramBuilder, station: PushStation, goal: ConstantVectorSource, scenario: Scenario
) -> EpisodeMonitor:
    points = station.model.reference_points
    monitor = EpisodeMonitor(points, scenario.episode, scenario.table)
    builder.AddSystem(monitor)
    for name in ("object_pose", "object_com", "tool_pose"):
        builder.Connect(station.diagram.GetOutputPort(name), monitor.GetInputPort(name))
    builder.Connect(goal.get_output_port(), monitor.GetInputPort("goal"))
    return monitor


def _add_planner(
    builder: DiagramBuilder,
    station: PushStation,
    goal: ConstantVectorSource,
    monitor: EpisodeMonitor,
    scenario: Scenario,
) -> PushPlanner:
    arm, period = ArmKinematics(scenario.robot), scenario.episode.policy_period
    planner = PushPlanner(arm, scenario.planner, scenario.control, scenario.table, period)
    builder.AddSystem(planner)
    for name in ("tool_pose", "arm_state"):
        builder.Connect(station.diagram.GetOutputPort(name), planner.GetInputPort(name))
    builder.Connect(goal.get_output_port(), planner.GetInputPort("goal"))
    builder.Connect(monitor.GetOutputPort("halted"), planner.GetInputPort("halted"))
    return planner
