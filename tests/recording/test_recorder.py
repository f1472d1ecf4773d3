"""Recording an episode: it changes nothing, and shows what the policy saw."""

import socket
from functools import cache
from html import escape
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Meshcat, MeshcatParams

from keypush.dataset.clouds import episode_clouds
from keypush.learning.checkpoint import save_network
from keypush.learning.eager import random_network
from keypush.networks.config import KeypointConfig
from keypush.recording import recorder
from keypush.recording.recorder import Recording, record_episode
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.scenario import Scenario, parse_scenario

EPISODE = 3


@cache
def scenario() -> Scenario:
    return parse_scenario("{policy: centroid, seed: 4, episode: {max_steps: 25}}")


@cache
def unrecorded() -> tuple[EpisodeRunner, EpisodeResult]:
    runner = EpisodeRunner(scenario())
    return runner, runner.run(EPISODE)


@cache
def recorded() -> Recording:
    return record_episode(scenario(), EPISODE)


def test_rows_are_the_same_bit_for_bit_as_without_recording() -> None:
    with_page, without = recorded().result, unrecorded()[1]
    assert with_page.rows.keys() == without.rows.keys()
    for name, column in without.rows.items():
        assert with_page.rows[name].tobytes() == column.tobytes(), name
    assert with_page.seconds == without.seconds
    assert str(with_page.summary) == str(without.summary)


def test_meshcats_port_is_closed_afterwards(monkeypatch: pytest.MonkeyPatch) -> None:
    ports = []

    class ListedMeshcat(Meshcat):
        def __init__(self, params: MeshcatParams) -> None:
            super().__init__(params)
            ports.append(self.port())

    monkeypatch.setattr(recorder, "Meshcat", ListedMeshcat)
    record_episode(parse_scenario("{policy: expert, episode: {max_steps: 1}}"))
    with pytest.raises(OSError, match="refused"), socket.create_connection(("localhost", ports[0])):
        pass


def test_an_object_of_another_size_is_recorded_in_the_diagram_that_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class WatchedRunner(EpisodeRunner):
        def run(self, episode: int) -> EpisodeResult:
            recorded = self.push
            result = super().run(episode)
            assert self.push is recorded
            return result

    monkeypatch.setattr(recorder, "EpisodeRunner", WatchedRunner)
    varied = parse_scenario(
        "{policy: expert, episode: {max_steps: 2}, variation: {size: [0.75, 1.25]}}"
    )
    summary = record_episode(varied, EPISODE).result.summary
    assert str(summary) == str(EpisodeRunner(varied).run(EPISODE).summary)
    assert summary["size_ratio"] != 1.0


def test_clouds_on_the_page_are_those_that_the_policy_saw() -> None:
    runner, result = unrecorded()
    poses = np.asarray(result.rows["object_pose"], dtype=float)
    clouds = episode_clouds(runner.scenario.noise, result.summary, poses)
    centroids = np.mean(clouds, axis=1)
    # The keypoint is the centroid of this step's or, as a predictor may take a step, of the
    # last step's cloud; the next row holds it.
    keypoints = np.asarray(result.rows["target"], dtype=float)[2:]
    now, before = centroids[1:-1], centroids[:-2]
    errors = [np.abs(keypoints - seen).max(axis=1) for seen in (now, before)]
    assert np.min(errors, axis=0).max() < 1e-12
    assert np.abs(now - before).max() > 1e-5


def test_a_policy_without_a_keypoint_has_none_in_its_legend(tmp_path: Path) -> None:
    weights = tmp_path / "mine.safetensors"
    clips = {"action_clips": {"translation": 0.06, "rotation": 0.1}}
    save_network(random_network("behavior_cloning", KeypointConfig()), weights, clips)
    acting = parse_scenario(
        "{policy: behavior_cloning, episode: {max_steps: 1}, "
        f"predictor: {{weights: '{weights}'}}}}"
    )
    html = record_episode(acting).html
    assert "keypoint and direction" not in html
    assert "point cloud</" in html
    assert "keypoint and direction" in recorded().html


def test_page_holds_title_story_and_no_unfilled_part() -> None:
    html = recorded().html
    assert "<title>keypush: A Franka Panda pushes the mug" in html
    assert escape(recorded().narration.outcome) in html
    overlay = html[html.index('id="keypush-story"') :]
    assert "{{" not in overlay.partition("<script>")[0]
