"""MakeOpenPushDiagram: the station and the monitor, with an input port where a policy acts."""

from dataclasses import dataclass

from pydrake.geometry import Meshcat, MeshcatVisualizer
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

from diagrams.episode_parts import add_goal_and_monitor, add_push_planner, add_visualizer, connect
from diagrams.station import MakePushStation, PushStation
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
    goal, monitor = add_goal_and_monitor(builder, station.diagram, model, scenario)
    tool_action, planner = station.diagram.GetInputPort("tool_action"), None
    if port == "keypoint":
        planner = add_push_planner(builder, station.diagram, goal, scenario)
        connect(builder, monitor, planner, ["halted"])
        builder.Connect(planner.GetOutputPort("tool_action"), tool_action)
        builder.ExportInput(planner.GetInputPort("keypoint"), port)
    else:
        builder.ExportInput(tool_action, port)
    visualizer = add_visualizer(builder, station.diagram, scenario, meshcat)
    diagram = builder.Build()
    diagram.set_name("open_push")
    return OpenPushDiagram(diagram, station, goal, monitor, planner, visualizer)
