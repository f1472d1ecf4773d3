"""Runs one episode and turns it into a page to watch."""

import gc
import logging
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, MeshcatParams, Rgba

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

Array = NDArray[np.float64]


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
    rows = result.rows
    poses, targets = (np.asarray(rows[name], dtype=float) for name in ("object_pose", "target"))
    # A row is logged before the planner acts on it: its keypoint stands in the next row. Where the
    # policy failed at once there is none.
    last = targets[-1:] if len(targets) > 1 else np.full((1, 3), np.nan)
    keypoints = np.concatenate([targets[1:], last])
    goal = np.asarray(rows["goal"][0], dtype=float)
    add_observations(meshcat, runner.scenario, result.summary, poses, keypoints, goal)
    narration = narrate(scenario, result)
    meshcat.PublishRecording()
    story = [narration.policy, narration.outcome]
    # A policy without a keypoint has none to explain.
    shown = _LEGEND if np.isfinite(keypoints).any() else _LEGEND[:-1]
    html = dress_page(meshcat.StaticHtml(), narration.title, story, shown, time_bar=True)
    return Recording(result, narration, html)


def add_observations(
    meshcat: Meshcat,
    scenario: Scenario,
    told: Mapping[str, Any],
    poses: Array,
    keypoints: Array,
    goal: Array,
) -> None:
    """Adds to a recording what does not move by itself: scenery, clouds, keypoint.

    Args:
        meshcat: has the recording.
        scenario: of the episode.
        told: of the episode: object, size_ratio, seed and episode.
        poses: X_WO of every frame, (n, 7).
        keypoints: p_WK of every frame, (n, 3), m; NaN where there is none.
        goal: (2,) goal xy in W, m.
    """
    add_scenery(meshcat, scenario, poses[0, 4:6], goal)
    animation = meshcat.get_mutable_recording()
    animate_clouds(meshcat, animation, episode_clouds(scenario.noise, told, poses))
    animate_keypoint(meshcat, animation, keypoints, goal)


def legend(keypoint: str) -> tuple[tuple[Rgba, str], ...]:
    """Returns the legend of a page; `keypoint` says what its keypoint is."""
    return ((GOAL_COLOUR, "goal"), (CLOUD_COLOUR, "point cloud"), (KEYPOINT_COLOUR, keypoint))


_LEGEND = legend("keypoint and direction of the push")


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
