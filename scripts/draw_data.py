"""Draws what a data set shows of the expert, and prints how varied its frames are.

    scripts/uv.sh run scripts/draw_data.py PLAIN RESET OUT.png

PLAIN and RESET are data sets of `keypush collect` without and with the reset heuristic. The panels
are those of the thesis' figures 4.4, 4.5 and 4.7: where the contact was meant to be and where it
was, the expert's path, and where the tool has been around the contact. The first two are of an
episode of the glass, or of the first object where a data set has none.
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import polars as pl
from as_command import as_command
from numpy.typing import NDArray

from keypush.cli.output import check_output_file
from keypush.dataset.poses import rotations
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.objects.library import make_object
from keypush.planning.plan_state import Stage

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Circle

Array = NDArray[np.float64]

_PREFERRED = "glass"
"""Round and tall."""
_HEAD = """| | episodes | frames | frames an episode | spread of the low tool along the push, cm
| beside it, cm | beside it while pushing, cm | directions around the object |""".replace("\n", " ")
_COLOURS = {"without resets": "tab:blue", "with resets": "tab:orange"}


def read(folder: Path) -> pl.DataFrame:
    """Reads all frames of a data set, with their episode's object.

    Raises:
        UserError: it is none.
    """
    open_dataset(folder)
    frames = pl.read_parquet(folder / "data" / "*" / "*.parquet")
    episodes = pl.read_parquet(folder / "meta" / "episodes" / "*" / "*.parquet")
    told = episodes.select("episode_index", "object", "size_ratio", "success")
    return frames.join(told, on="episode_index", how="left")


def points(frames: pl.DataFrame, column: str) -> Array:
    """Returns a column of lists as (n, k)."""
    return np.asarray(frames[column].to_numpy(), dtype=float).reshape(len(frames), -1)


def in_push_frame(frames: pl.DataFrame, p_W: Array) -> Array:
    """Returns points (n, 2+) relative to the analytic contact: along the push, to its left, m."""
    com, goal = points(frames, "observation.com"), points(frames, "observation.goal")
    d = goal - com[:, :2]
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    offset = p_W[:, :2] - points(frames, "contact.analytic")[:, :2]
    left = np.column_stack([-d[:, 1], d[:, 0]])
    return np.column_stack([np.sum(offset * d, axis=1), np.sum(offset * left, axis=1)])


def low(frames: pl.DataFrame) -> pl.DataFrame:
    """Keeps frames in which the tool is low, which is where it meets the object."""
    tool_z = pl.col("observation.tool_pose").arr.get(6)
    aimed = pl.col("contact.analytic").arr.get(0).is_not_nan()
    return frames.filter((tool_z < 0.06) & (pl.col("stage") < 6) & aimed)


def bearings(frames: pl.DataFrame) -> Array:
    """Returns the direction (n,) in O from the object's origin to the tool, rad."""
    pose, tool = points(frames, "observation.object_pose"), points(frames, "observation.tool_pose")
    offset = tool[:, 4:] - pose[:, 4:]
    p_O = np.einsum("nij,ni->nj", rotations(pose), offset)
    return np.asarray(np.arctan2(p_O[:, 1], p_O[:, 0]))


def tell(name: str, frames: pl.DataFrame) -> str:
    """Returns one row of the table: how spread the tool is around contact and object."""
    near = low(frames)
    along, left = in_push_frame(near, points(near, "observation.tool_pose")[:, 4:]).T
    tool = near.with_columns(bearing=pl.Series(bearings(near)))
    sectors = tool.with_columns(sector=(pl.col("bearing") / (2 * np.pi) * 36).floor())
    filled = (
        np.mean(sectors.group_by("object").agg(pl.col("sector").n_unique())["sector"].to_numpy())
        / 36
    )
    pushing = near.filter(pl.col("stage") == Stage.PUSH)
    push_left = in_push_frame(pushing, points(pushing, "observation.tool_pose")[:, 4:])[:, 1]
    episodes = frames["episode_index"].n_unique()
    cells = [
        name, str(episodes), str(len(frames)), f"{len(frames) / episodes:.0f}",
        f"{100 * along.std():.1f}", f"{100 * left.std():.1f}", f"{100 * push_left.std():.1f}",
        f"{filled:.0%}",
    ]  # fmt: skip
    return f"| {' | '.join(cells)} |"


def shown_episode(frames: pl.DataFrame) -> pl.DataFrame:
    """Returns the frames of the episode that stands for all.

    Raises:
        UserError: no push of the data set touched its object.
    """
    touching = _touching(frames)
    if touching.is_empty():
        raise UserError("no frame of the data set pushes with contact; allowed: one that does")
    preferred = touching.filter(pl.col("object") == _PREFERRED)
    first = (touching if preferred.is_empty() else preferred)["episode_index"].min()
    return frames.filter(pl.col("episode_index") == first)


def _touching(frames: pl.DataFrame) -> pl.DataFrame:
    measured = pl.col("contact.measured").arr.get(0).is_not_nan()
    return frames.filter((pl.col("stage") == Stage.PUSH) & measured)


def draw_contacts(axes: Axes, frames: pl.DataFrame) -> None:
    """One episode's object from above, with the contacts that were meant and those that were."""
    touching = _touching(shown_episode(frames))
    shown = touching["object"][0]
    pose = points(touching, "observation.object_pose")
    R_WO, p_WO = rotations(pose), pose[:, 4:]
    for column, colour, label in (
        ("contact.measured", "tab:green", "measured"),
        ("contact.analytic", "black", "aimed at"),
    ):
        p_O = np.einsum("nij,ni->nj", R_WO, points(touching, column) - p_WO)
        axes.plot(100 * p_O[:, 0], 100 * p_O[:, 1], ".", color=colour, label=label)
    ratio = float(touching["size_ratio"][0])
    cloud = 100 * make_object(shown, ratio).p_OP
    axes.plot(cloud[::4, 0], cloud[::4, 1], ",", color="0.75")
    axes.set(title=f"contacts of one push, {shown}", xlabel="Ox, cm", ylabel="Oy, cm")
    axes.set_aspect("equal")
    axes.legend(loc="upper right", fontsize=8)


def draw_path(axes: Axes, frames: pl.DataFrame) -> None:
    """One episode's way of tool and object from above."""
    one = shown_episode(frames)
    tool = 100 * points(one, "observation.tool_pose")[:, 4:]
    thing = 100 * points(one, "observation.object_pose")[:, 4:]
    goal = 100 * points(one, "observation.goal")[0]
    axes.plot(tool[:, 0], tool[:, 1], color="tab:blue", lw=1, label="tool")
    axes.plot(thing[:, 0], thing[:, 1], color="tab:brown", lw=3, label="object")
    axes.add_patch(Circle((goal[0], goal[1]), 5.0, color="tab:green", alpha=0.3))
    axes.set(title="an episode from above", xlabel="Wx, cm", ylabel="Wy, cm")
    axes.set_aspect("equal")
    axes.legend(fontsize=8)


def draw_spread(axes: Axes, data: dict[str, pl.DataFrame]) -> None:
    """Where the low tool has been around the contact."""
    for name, frames in reversed(data.items()):
        near = low(frames)
        at = 100 * in_push_frame(near, points(near, "observation.tool_pose")[:, 4:])
        axes.plot(at[:, 1], at[:, 0], ",", color=_COLOURS[name])
        axes.plot([], [], "s", color=_COLOURS[name], label=name)
    axes.axhline(0, color="0.5", lw=0.5)
    axes.axvline(0, color="0.5", lw=0.5)
    axes.set(title="low tool around the contact", xlabel="left of the push, cm",
             ylabel="along it, cm", xlim=(-15, 15), ylim=(-15, 5))  # fmt: skip
    axes.legend(fontsize=8)


def draw_deviation(axes: Axes, data: dict[str, pl.DataFrame]) -> None:
    """How far beside the aimed contact the measured one was."""
    for name, frames in data.items():
        near = _touching(frames)
        beside = in_push_frame(near, points(near, "contact.measured"))[:, 1]
        beside = beside[np.isfinite(beside)]
        axes.hist(100 * beside, bins=np.linspace(-4, 4, 81).tolist(), density=True, histtype="step",
                  color=_COLOURS[name], label=name)  # fmt: skip
    axes.set(
        title="measured contact beside the aimed one",
        xlabel="left of the push, cm",
        ylabel="density",
    )
    axes.legend(fontsize=8)


def main(plain: Path, reset: Path, out: Path) -> None:
    """Draws the figure and prints the table.

    Args:
        plain: data set without resets.
        reset: data set with resets.
        out: the figure.
    """
    check_output_file(out)
    data = dict(zip(_COLOURS, (read(plain), read(reset)), strict=True))
    figure, axes = plt.subplots(1, 4, figsize=(17, 4))
    draw_contacts(axes[0], data["without resets"])
    draw_path(axes[1], data["with resets"])
    draw_spread(axes[2], data)
    draw_deviation(axes[3], data)
    figure.tight_layout()
    figure.savefig(out, dpi=90)
    print(_HEAD)
    print("|---|---|---|---|---|---|---|---|")
    for name, frames in data.items():
        print(tell(name, frames))


if __name__ == "__main__":
    as_command(main)
