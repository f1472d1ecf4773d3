"""The recorded page in a real, headless Chromium."""

import io
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray
from playwright.sync_api import Page, sync_playwright

from keypush.recording.recorder import Recording, record_episode
from keypush.robot.panda import NUM_JOINTS
from keypush.scenario import parse_scenario

LARGEST_PAGE = 12_000_000
# Software rendering, so that no graphics card is needed.
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
]
SEEK = """time => {
    const slider = document.querySelector("#keypush-time input");
    slider.value = time;
    slider.oninput();
}"""
OBJECT_POSITION = """() => viewer.scene_tree.find(
    ["drake", "visualizer", "object", "object"]).object.position.toArray()"""
VERTICES = """path => {
    let count = 0;
    viewer.scene_tree.find(path).object.traverse(node => {
        if (node.isMesh) count += node.geometry.attributes.position.count;
    });
    return count;
}"""
VISIBLE_CLOUDS = """() => viewer.scene_tree.find(["point_cloud"]).object.children
    .filter(cloud => cloud.visible).map(cloud => cloud.name)"""
READY = """() => viewer.animator.duration > 0 && viewer.scene_tree.find(
    ["drake", "visualizer", "panda", "panda_link0"]).object.getObjectByName("geometry_0")"""


@dataclass
class Opened:
    """A page, and what it said and asked for while it was open."""

    page: Page
    recording: Recording
    size: int
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def seek(self, time: float) -> None:
        self.page.evaluate(SEEK, time)

    def evaluate(self, script: str, argument: object = None) -> Any:
        return self.page.evaluate(script, argument)


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("no chromium on the PATH (Debian's package: chromium)")
    recording = record_episode(parse_scenario("{policy: expert, object: {name: plate}}"))
    file = tmp_path_factory.mktemp("page") / "recording.html"
    file.write_text(recording.html, encoding="utf-8")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={"width": 960, "height": 600})
        opened = Opened(page, recording, file.stat().st_size)
        page.on("console", lambda message: opened.complaints.append(message.text))
        page.on("pageerror", lambda error: opened.complaints.append(str(error)))
        page.on("request", lambda request: opened.requests.append(request.url))
        page.goto(file.as_uri())
        page.wait_for_function(READY)
        yield opened
        browser.close()


def test_page_is_small_silent_and_self_contained(opened: Opened) -> None:
    opened.seek(0.0)
    assert opened.size <= LARGEST_PAGE
    assert opened.complaints == []
    outside = [url for url in opened.requests if not url.startswith("data:")]
    assert [Path(url).name for url in outside] == ["recording.html"]


def test_every_link_of_the_robot_has_its_mesh(opened: Opened) -> None:
    links = [f"panda_link{i}" for i in range(NUM_JOINTS + 1)] + ["panda_hand", "panda_leftfinger"]
    for link in links:
        assert opened.evaluate(VERTICES, ["drake", "visualizer", "panda", link]) > 500, link


def test_robot_is_in_view(opened: Opened) -> None:
    opened.seek(0.0)
    hide = """visible => {
        viewer.scene_tree.find(["drake", "visualizer", "panda"]).object.visible = visible;
        viewer.render();
    }"""
    shots = []
    for visible in (True, False):
        opened.evaluate(hide, visible)
        shots.append(_pixels(opened))
    opened.evaluate(hide, True)
    changed = np.abs(shots[0] - shots[1]).max(axis=2) > 0.02
    assert changed.mean() > 0.03


def test_animation_takes_the_object_along_its_rows_to_the_goal(opened: Opened) -> None:
    rows = opened.recording.result.rows
    assert opened.recording.result.summary["success"]
    for step in (0, len(rows["time"]) // 2, -1):
        opened.seek(float(rows["time"][step]))
        shown = np.array(opened.evaluate(OBJECT_POSITION))
        assert np.abs(shown - np.asarray(rows["object_pose"])[step, 4:]).max() < 1e-4
    start, goal = rows["object_pose"][0, 4:6], rows["goal"][0]
    assert np.linalg.norm(shown[:2] - goal) <= 0.05 < np.linalg.norm(start - goal)


def test_one_cloud_is_visible_at_a_time(opened: Opened) -> None:
    times = opened.recording.result.rows["time"]
    for step in (7, 0, len(times) - 1, 3):
        opened.seek(float(times[step]) + 0.02)
        assert opened.evaluate(VISIBLE_CLOUDS) == [f"{step:05d}"]


def test_page_plays_from_its_button(opened: Opened) -> None:
    opened.seek(1.0)
    opened.evaluate("() => document.querySelector('#keypush-time button').click()")
    opened.page.wait_for_function("() => viewer.animator.time > 1.3")
    opened.evaluate("() => document.querySelector('#keypush-time button').click()")


def _pixels(opened: Opened) -> NDArray[np.float64]:
    """RGB in [0, 1], (h, w, 3)."""
    return np.asarray(imread(io.BytesIO(opened.page.screenshot()), format="png"))[..., :3]
