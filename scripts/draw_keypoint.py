"""Draws docs/keypoint.png: what the keypoint of a frame is, from above, in a real episode."""

from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from keypush.dataset.frames import Columns, frames_of_episode
from keypush.objects.library import make_object
from keypush.objects.model import ObjectModel
from keypush.objects.point_cloud import pose_from_vector
from keypush.planning.plan_state import Stage
from keypush.rollout.episode import EpisodeRunner
from keypush.rollout.parquet import table_from_rows
from keypush.scenario import parse_scenario

OUT = Path(__file__).resolve().parents[1] / "docs" / "keypoint.png"
OBJECT = "telephone"
SCENARIO = f"{{policy: expert, seed: 0, object: {{name: {OBJECT}}}}}"
EPISODE = 0
OBJECT_COLOUR, GOAL_COLOUR, KEYPOINT_COLOUR, COM_COLOUR = "#c9d3e3", "#2a8c4a", "#f21a73", "#1f2a44"
TOOL_COLOUR = "#8a8f98"


def main() -> None:
    """Runs the episode and draws a frame before the push and one in it."""
    scenario = parse_scenario(SCENARIO)
    result = EpisodeRunner(scenario).run(EPISODE)
    frames = frames_of_episode(table_from_rows([result.rows]), success=True)
    touches = np.isfinite(frames["contact.measured"]).all(axis=1) & (frames["stage"] == Stage.PUSH)
    first, last = np.flatnonzero(touches)[[0, -1]]
    middle = np.flatnonzero(touches)[touches.sum() // 2]
    model = make_object(OBJECT)
    figure = Figure(figsize=(11, 5.2), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    titles = (
        (max(0, first - 15), "before the push: the contact to come, carried on the object"),
        (middle, "in the push: the contact that is measured"),
    )
    for axes, (step, title) in zip(panels, titles, strict=True):
        _draw(axes, model, frames, int(step), scenario.episode.goal_radius)
        axes.set_title(f"frame {step}, {title}", fontsize=10)
        axes.set_aspect("equal")
        axes.set_xlabel("x in W (m)")
    _frame(panels[0], frames, int(last))
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=6, frameon=False, fontsize=9)
    figure.savefig(OUT, facecolor="white", metadata={"Software": None})
    print(f"written: {OUT}")


def _draw(axes: Axes, model: ObjectModel, frames: Columns, step: int, radius: float) -> None:
    pose = np.asarray(frames["observation.object_pose"], dtype=float)[step]
    com = np.asarray(frames["observation.com"], dtype=float)[step, :2]
    goal = np.asarray(frames["observation.goal"], dtype=float)[step]
    keypoint = np.asarray(frames["keypoint"], dtype=float)[step, :2]
    tool = np.asarray(frames["observation.tool_pose"], dtype=float)[step, 4:6]
    measured = np.asarray(frames["contact.measured"], dtype=float)[step, :2]
    for ring in _outline(model, pose):
        axes.add_patch(Polygon(ring, facecolor=OBJECT_COLOUR, edgecolor=COM_COLOUR, zorder=1))
    axes.add_patch(Circle(tuple(goal), radius, facecolor="none", edgecolor=GOAL_COLOUR, zorder=1))
    axes.plot(*goal, "+", color=GOAL_COLOUR, markersize=12, label="goal, and how near is enough")
    axes.annotate(
        "", goal, com, arrowprops={"arrowstyle": "->", "color": COM_COLOUR, "lw": 1.2}, zorder=2
    )
    axes.plot([], [], color=COM_COLOUR, label="direction of the push")
    axes.plot(*com, "o", color=COM_COLOUR, markersize=7, label="centre of mass", zorder=3)
    axes.plot(*tool, "s", color=TOOL_COLOUR, markersize=9, label="tool tip", zorder=3)
    axes.plot(*keypoint, "o", color=KEYPOINT_COLOUR, markersize=11, label="keypoint", zorder=4)
    if np.isfinite(measured).all():
        axes.plot(*measured, "kx", markersize=8, label="measured contact", zorder=5)


def _outline(model: ObjectModel, pose: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """The object seen from above: outlines (k, 2) in W, m."""
    p_WV = np.asarray(pose_from_vector(pose).multiply(model.vertices.T)).T[:, :2]
    triangles = shapely.polygons(p_WV[model.faces])
    shape = shapely.union_all(triangles[shapely.area(triangles) > 1e-12]).buffer(1e-4)
    parts = shapely.get_parts(shape)
    return [np.asarray(part.exterior.coords) for part in parts]


def _frame(axes: Axes, frames: Columns, last: int) -> None:
    """Shows the part of the table in which all of it happens."""
    shown = np.vstack([
        np.asarray(frames["observation.object_pose"], dtype=float)[: last + 1, 4:6],
        np.asarray(frames["observation.goal"], dtype=float)[:1],
    ])  # fmt: skip
    low, high = shown.min(axis=0) - 0.085, shown.max(axis=0) + 0.085
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_ylabel("y in W (m)")


if __name__ == "__main__":
    main()
