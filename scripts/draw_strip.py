"""Draws docs/push.png and docs/push.gif: the push of an unseen object, as its recording shows it.

    scripts/uv.sh run scripts/draw_strip.py

Needs Chromium; a minute on one core.
"""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from stills import View, open_recordings, side_view, stills

from keypush.planning.plan_state import Stage
from keypush.recording.recorder import record_episode
from keypush.scenario import parse_scenario

DOCS = Path(__file__).resolve().parents[1] / "docs"
SCENARIO = "{policy: surface_no_com, object: {name: star_prism}}"
EPISODE = 9
_PANEL, _GAP = 394, 8
"""Four panels and three gaps are 1600 pixels."""
_COLOURS = 256
_STRIP_DISTANCE, _FILM_DISTANCE = 0.74, 0.80
"""From the camera to the middle of the push, m."""
_FILM_SIZE = (600, 360)
_FRAME_MS, _LAST_FRAME_MS = 80, 1500
"""A GIF counts hundredths of a second: 12.5 frames in each, as fast as it happened."""
_FILM_COLOURS, _PALETTE_FRAMES = 128, 6
_REST = 0.6
"""How long the film goes on at the goal, s; the recording waits for the settled test."""
_INK = (29, 36, 48)

Array = NDArray[np.float64]


def main() -> None:
    """Records the episode and draws it twice."""
    recording = record_episode(parse_scenario(SCENARIO), EPISODE)
    rows = recording.result.rows
    start, goal = np.asarray(rows["object_pose"][0, 4:6]), np.asarray(rows["goal"][0])
    stage, times = np.asarray(rows["stage"], dtype=int), np.asarray(rows["time"], dtype=float)
    end = float(times[np.flatnonzero(stage == Stage.PUSH)[-1]]) + _REST
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "recording.html"
        page.write_text(recording.html, encoding="utf-8")
        view = side_view(start, goal, _STRIP_DISTANCE)
        panels = list(_panels(page, stage, times, view))
        film = _film(page, end, side_view(start, goal, _FILM_DISTANCE))
    _write_strip(panels, DOCS / "push.png")
    _write_film(film, DOCS / "push.gif")


def _panels(
    page: Path, stage: NDArray[np.integer], times: Array, view: View
) -> Iterator[Image.Image]:
    """Yields start, approach, push and goal, named."""
    push = np.flatnonzero(stage == Stage.PUSH)
    moments = {
        "start": 0,
        "approach": int(push[0]),
        "push": int(push[len(push) * 3 // 5]),
        "goal": len(times) - 1,
    }
    with open_recordings((_PANEL, _PANEL)) as browser:
        shots = stills(browser, page, [float(times[step]) for step in moments.values()], view)
        for (name, step), shot in zip(moments.items(), shots, strict=True):
            yield _named(shot, f"{name}, {times[step]:.1f} s")


def _named(picture: Image.Image, text: str) -> Image.Image:
    ImageDraw.Draw(picture).text((14, _PANEL - 36), text, _INK, font=ImageFont.load_default(20))
    return picture


def _film(page: Path, end: float, view: View) -> list[Image.Image]:
    times = np.arange(0.0, end, _FRAME_MS / 1000)
    with open_recordings(_FILM_SIZE) as browser:
        return list(stills(browser, page, times.tolist(), view))


def _write_strip(panels: Sequence[Image.Image], path: Path) -> None:
    strip = Image.new("RGB", (len(panels) * (_PANEL + _GAP) - _GAP, _PANEL), "white")
    for i, panel in enumerate(panels):
        strip.paste(panel, (i * (_PANEL + _GAP), 0))
    strip.quantize(_COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"written: {path}, {path.stat().st_size / 1e3:.0f} kB")


def _write_film(frames: Sequence[Image.Image], path: Path) -> None:
    """Writes frames that share their colours, without dither: so what rests costs nothing."""
    chosen = [frames[i] for i in np.linspace(0, len(frames) - 1, _PALETTE_FRAMES).astype(int)]
    palette = _below(chosen).quantize(_FILM_COLOURS, method=Image.Quantize.FASTOCTREE)
    shared = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    durations = [_FRAME_MS] * (len(shared) - 1) + [_LAST_FRAME_MS]
    first, *others = shared
    first.save(path, save_all=True, append_images=others, duration=durations, loop=0, optimize=True)
    print(f"written: {path}, {path.stat().st_size / 1e3:.0f} kB")


def _below(frames: Sequence[Image.Image]) -> Image.Image:
    return Image.fromarray(np.concatenate([np.asarray(frame) for frame in frames]))


if __name__ == "__main__":
    main()
