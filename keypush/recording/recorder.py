"""Runs one episode and turns it into a page to watch."""

import gc
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat, MeshcatParams

from keypush.dataset.clouds import episode_clouds
from keypush.recording.narration import Narration, narrate
from keypush.recording.observations import (
    CLOUD_COLOUR,
    KEYPOINT_COLOUR,
    animate_clouds,
    animate_keypoint,
)
from keypush.recording.page import dress_page
from keypush.recording.scenery import GOAL_COLOUR, add_scenery
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.scenario import Scenario

_LEGEND = (
    (GOAL_COLOUR, "goal"),
    (CLOUD_COLOUR, "point cloud"),
    (KEYPOINT_COLOUR, "keypoint and direction of the push"),
)


@dataclass(frozen=True)
class Recording:
    """An episode and its page."""

    result: EpisodeResult
    """The same, bit for bit, as without recording."""
    narration: Narration
    html: str
    """A self-contained page that plays the episode."""


def record_episode(scenario: Scenario, episode: int = 0) -> Recording:
    """Runs an episode while Meshcat records it.

    One frame per policy step: more would change the steps of the integrator. The browser
    interpolates between frames. No browser and no network are needed; Meshcat listens on a
    port of localhost until this function returns.

    Raises:
        UserError: see `EpisodeRunner`.
        RuntimeError: the simulation failed, or no port is free.
    """
    try:
        return _record(scenario, episode)
    finally:
        # Diagrams stand in reference cycles: Meshcat's port closes when these are found.
        gc.collect()


def _record(scenario: Scenario, episode: int) -> Recording:
    meshcat = make_meshcat()
    runner = EpisodeRunner(scenario, meshcat)
    runner.reset(episode)  # so that the diagram is the one that has the episode's size
    visualizer = runner.push.visualizer
    assert visualizer is not None
    visualizer.StartRecording(set_transforms_while_recording=False)
    result = runner.run(episode)
    visualizer.StopRecording()
    _add_observations(meshcat, runner, result)
    narration = narrate(scenario, result)
    meshcat.PublishRecording()
    story = [narration.policy, narration.outcome]
    html = dress_page(meshcat.StaticHtml(), narration.title, story, _LEGEND, time_bar=True)
    return Recording(result, narration, html)


def _add_observations(meshcat: Meshcat, runner: EpisodeRunner, result: EpisodeResult) -> None:
    scenario, rows = runner.scenario, result.rows
    goal = np.asarray(rows["goal"][0], dtype=float)
    poses = np.asarray(rows["object_pose"], dtype=float)
    add_scenery(meshcat, scenario, poses[0, 4:6], goal)
    clouds = episode_clouds(scenario.noise, result.summary, poses)
    animation = meshcat.get_mutable_recording()
    animate_clouds(meshcat, animation, clouds)
    # A row is logged before the planner acts on it: its keypoint stands in the next row.
    targets = np.asarray(rows["target"], dtype=float)
    animate_keypoint(meshcat, animation, np.concatenate([targets[1:], targets[-1:]]), goal)


def make_meshcat() -> Meshcat:
    """Starts a Meshcat that serves localhost alone and says nothing of it."""
    params = MeshcatParams()
    params.host = "localhost"
    with _quiet_drake():
        return Meshcat(params)


@contextmanager
def _quiet_drake() -> Iterator[None]:
    """Keeps Drake from announcing an address that nobody needs."""
    logger = logging.getLogger("drake")
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)
