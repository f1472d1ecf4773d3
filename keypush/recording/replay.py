"""Turns an episode of a data set into a page to watch, from its frames alone."""

import gc
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams
from pydrake.math import RigidTransform
from pydrake.systems.framework import DiagramBuilder

from diagrams.station import MakePushStation
from keypush.dataset.arrays import to_array
from keypush.dataset.episode_scenario import episode_scenario
from keypush.dataset.own_objects import refuse_changed_objects
from keypush.dataset.read import DataSet
from keypush.objects.library import make_object
from keypush.objects.point_cloud import pose_from_vector
from keypush.recording.narration import narrate
from keypush.recording.page import dress_page
from keypush.recording.recorder import add_observations, legend, make_meshcat
from keypush.robot.panda import NUM_JOINTS
from keypush.rollout.episode import EpisodeResult
from keypush.scenario import Scenario

_LEGEND = legend("keypoint, the label, and direction to the goal")

Array = NDArray[np.float64]


def replay_episode(dataset: DataSet, number: int) -> str:
    """Returns a self-contained page that plays an episode; nothing is simulated.

    Raises:
        UserError: there is no such episode, a file is damaged, or the object is not there, or is
            another by now.
        RuntimeError: no port is free for Meshcat.
    """
    refuse_changed_objects(dataset)
    told, frames = dataset.episode(number)
    try:
        return _replay(episode_scenario(dataset, told), told, frames)
    finally:
        gc.collect()  # Meshcat's port closes when it is found.


def _replay(scenario: Scenario, told: dict[str, Any], frames: pa.Table) -> str:
    poses = to_array(frames["observation.object_pose"])
    q = to_array(frames["observation.state"])[:, :NUM_JOINTS].astype(np.float64)
    goal = to_array(frames["observation.goal"])[0].astype(np.float64)
    meshcat = make_meshcat()
    _record(meshcat, scenario, q, poses)
    keypoints = to_array(frames["keypoint"]).astype(np.float64)
    add_observations(meshcat, scenario, told, poses, keypoints, goal)
    meshcat.PublishRecording()
    summary = {**told, "final_position": poses[-1, 4:]}
    seconds = (len(frames) - 1) * scenario.episode.policy_period
    narration = narrate(scenario, EpisodeResult(summary, {"goal": goal[None]}, seconds))
    story = [
        f"Episode {told['episode_index']} of a data set, replayed from its frames.",
        narration.outcome,
    ]
    return dress_page(meshcat.StaticHtml(), narration.title, story, _LEGEND, time_bar=True)


def _record(meshcat: Meshcat, scenario: Scenario, q: Array, poses: Array) -> None:
    """Puts robot (n, 7) and object (n, 7) in their places, a frame after the other."""
    model = make_object(scenario.object.name, scenario.object.size_ratio, scenario.object.mass)
    station = MakePushStation(scenario, model, visuals=True)
    builder = DiagramBuilder()
    builder.AddSystem(station.diagram)
    period = scenario.episode.policy_period
    visualizer = MeshcatVisualizer.AddToBuilder(
        builder,
        station.diagram.GetOutputPort("query_object"),
        meshcat,
        MeshcatVisualizerParams(publish_period=period),
    )
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    plant = station.plant
    plant_context = plant.GetMyMutableContextFromRoot(context)
    visualizer.StartRecording(set_transforms_while_recording=False)
    for step, (joints, pose) in enumerate(zip(q, poses, strict=True)):
        context.SetTime(step * period)
        plant.SetPositions(plant_context, station.panda.instance, joints)
        X_WO: RigidTransform = pose_from_vector(pose)
        plant.SetFreeBodyPose(plant_context, station.object_body, X_WO)
        visualizer.ForcedPublish(visualizer.GetMyContextFromRoot(context))
    visualizer.StopRecording()
