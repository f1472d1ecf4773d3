"""The gripper of the real plant, as an oracle: Drake's signed distances to its palm and fingers."""

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Role
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from keypush.robot.panda import add_panda
from keypush.scenario import RobotConfig, SimulationConfig


def gripper_distances(p_EP: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed distances (n,) of points (n, 3) in E to the collision shapes of the hand, m."""
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.01)
    panda = add_panda(plant, RobotConfig(), SimulationConfig())
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(context))
    X_WE = panda.tool_frame.CalcPoseInWorld(plant.GetMyContextFromRoot(context))
    frame = plant.GetBodyFrameIdOrThrow(panda.tool_body.index())
    inspector = scene_graph.model_inspector()
    shapes = set(inspector.GetGeometries(frame, Role.kProximity))
    names = {inspector.GetName(shape).split("::")[-1] for shape in shapes}
    assert names == {"palm", "fingers"}
    least = []
    for p_WP in p_EP @ X_WE.rotation().matrix().T + X_WE.translation():
        found = query.ComputeSignedDistanceToPoint(p_WP)
        least.append(min(entry.distance for entry in found if entry.id_G in shapes))
    return np.array(least)
