"""Pictures of a recording at chosen times, as a headless Chromium shows it."""

import io
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Page, sync_playwright

from keypush.errors import UserError

_FLAGS = [
    "--no-sandbox",
    # Software rendering, so that no graphics card is needed.
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
]
_READY = """() => viewer.animator.duration > 0 && viewer.scene_tree.find(
    ["drake", "visualizer", "panda", "panda_link0"]).object.getObjectByName("geometry_0")
    && document.querySelector("#keypush-time input").max !== "" """
_SCENE_ALONE = "#keypush-story, #keypush-time, .dg { display: none !important; }"
_TARGET_HEIGHT = 0.09
_AHEAD, _ABOVE = 0.35, 0.65
"""Of the camera, in units of how far beside the push it is."""
_SEEK = """time => {
    const slider = document.querySelector("#keypush-time input");
    slider.value = time;
    slider.oninput();
    viewer.render();
}"""
# The scene's z axis is three.js' y axis.
_LOOK = """([[x, y, z], [a, b, c]]) => {
    viewer.camera.position.set(x, z, -y);
    viewer.set_camera_target([a, c, -b]);
    viewer.controls.update();
}"""
_ENLARGE = "scale => viewer.set_property(['keypoint'], 'scale', [scale, scale, scale])"
_PATIENCE_MS = 180_000
"""Software rendering takes long on a busy machine."""
_KEYPOINT_SCALE = 2.0
"""In small pictures the keypoint would hardly be seen."""

Array = NDArray[np.float64]
View = tuple[Array, Array]
"""Where the camera is, and what it looks at, (3,) in W, m."""


def side_view(start: Array, goal: Array, distance: float) -> View:
    """Returns a view of a push from its side, and a little from its front.

    So the hand, which is behind the object, hides neither object nor keypoint.

    Args:
        start: (2,) xy in W where the object starts, m.
        goal: (2,) goal xy in W, m.
        distance: from the middle of the push, m.
    """
    d = (goal - start) / np.linalg.norm(goal - start)
    left = np.array([-d[1], d[0]])
    side = left if left[0] > 0 else -left  # the one away from the robot
    away = np.array([*(side + _AHEAD * d), _ABOVE])
    target = np.array([*(start + goal) / 2, _TARGET_HEIGHT])
    return target + distance * away / np.linalg.norm(away), target


@contextmanager
def open_recordings(size: tuple[int, int], scale: float = 1.0) -> Iterator[Page]:
    """Opens a browser for `stills`.

    Args:
        size: width and height of the scene.
        scale: pixels of the pictures in one of `size`: above 1 lines are finer.

    Raises:
        UserError: there is no Chromium.
    """
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        raise UserError("chromium: is not on the PATH; allowed: Debian's package chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=_FLAGS)
        width, height = size
        page = browser.new_page(
            viewport={"width": width, "height": height}, device_scale_factor=scale
        )
        page.set_default_timeout(_PATIENCE_MS)
        yield page
        browser.close()


def stills(
    page: Page, recording: Path, times: Sequence[float], view: View | None = None
) -> Iterator[Image.Image]:
    """Yields pictures of the scene alone, without story and time bar.

    Args:
        page: of `open_recordings`.
        recording: page of an episode.
        times: s; beyond the end the last frame is shown.
        view: None where the recording's own is to stay.
    """
    page.goto(recording.resolve().as_uri())
    page.wait_for_function(_READY)
    page.add_style_tag(content=_SCENE_ALONE)
    page.evaluate(_ENLARGE, _KEYPOINT_SCALE)
    if view is not None:
        page.evaluate(_LOOK, [point.tolist() for point in view])
    for time in times:
        page.evaluate(_SEEK, time)
        shot = page.screenshot()
        yield Image.open(io.BytesIO(shot)).convert("RGB")
