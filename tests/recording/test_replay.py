"""An episode of a data set as a page: in a real browser everything is where the frames say."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import sync_playwright

from keypush.dataset.arrays import to_array
from keypush.dataset.assemble import assemble_dataset
from keypush.dataset.read import open_dataset
from keypush.recording.replay import replay_episode
from tests.dataset.real_shards import write_real_shards
from tests.recording.test_browser import FLAGS, OBJECT_POSITION, READY, SEEK, VISIBLE_CLOUDS

KEYPOINT_VISIBLE = """() => viewer.scene_tree.find(["keypoint"]).object.visible"""
HAND_POSITION = """() => {
    const hand = viewer.scene_tree.find(["drake", "visualizer", "panda", "panda_hand"]).object;
    return hand.position.toArray();
}"""
STARTED = '() => document.querySelector("#keypush-time input").max !== ""'
"""Before that, the page would go back to its beginning."""
HAND_TO_TIP = 0.1034


def test_the_page_shows_the_frames(tmp_path: Path) -> None:
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("no chromium on the PATH (Debian's package: chromium)")
    assemble_dataset(write_real_shards(tmp_path / "shards"), tmp_path)
    dataset = open_dataset(tmp_path)
    file = tmp_path / "page.html"
    file.write_text(replay_episode(dataset, 2), encoding="utf-8")
    _, frames = dataset.episode(2)
    poses = to_array(frames["observation.object_pose"])
    tools = to_array(frames["observation.tool_pose"])
    complaints: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={"width": 960, "height": 600})
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(file.as_uri())
        page.wait_for_function(READY)
        page.wait_for_function(STARTED)
        for step in (0, 8, len(frames) - 1):
            page.evaluate(SEEK, 0.1 * step + 0.001)
            shown = np.array(page.evaluate(OBJECT_POSITION))
            np.testing.assert_allclose(shown, poses[step, 4:], atol=1e-3)
            hand = np.array(page.evaluate(HAND_POSITION))
            reach = np.linalg.norm(hand - tools[step, 4:])
            assert reach == pytest.approx(HAND_TO_TIP, abs=2e-3)
            assert page.evaluate(VISIBLE_CLOUDS) == [f"{step:05d}"]
            # In a second and a half nothing is touched: there is no keypoint.
            assert page.evaluate(KEYPOINT_VISIBLE) is False
        browser.close()
    assert np.isnan(to_array(frames["keypoint"])).all()
    assert complaints == []
