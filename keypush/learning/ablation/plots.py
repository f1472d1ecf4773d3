"""Training and validation curves, as in the thesis' figure 5.4."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from keypush.learning.ablation.results import Ablation, Epoch, Training
from keypush.learning.ablation.settings import SETTINGS, SHOWN, Setting
from keypush.networks.normalisation import LENGTH

_DPI = 110
_CURVES: Sequence[tuple[str, str, Callable[[Epoch], float]]] = (
    ("held-out objects", "#c1272d", lambda epoch: epoch.held_out_error),
    ("other episodes of the trained objects", "#1f5fa8", lambda epoch: epoch.validation_error),
    (
        "training, root mean square, with dropout",
        "#7a7a7a",
        lambda epoch: LENGTH * math.sqrt(3 * epoch.train_mse),
    ),
)
"""Label, colour and error in m; a mean square is that of a coordinate, of which there are three."""


def draw_best(ablation: Ablation, path: Path) -> None:
    """Writes the curves of the thesis' two best settings, side by side, as PNG."""
    figure = Figure(figsize=(9, 3.8), dpi=_DPI, layout="constrained")
    panels = figure.subplots(1, len(SHOWN), sharey=True)
    for axes, setting in zip(panels, SHOWN, strict=True):
        _draw(axes, ablation.of(setting), setting)
        axes.set_xlabel("epoch")
    panels[0].set_ylim(0, _highest(ablation, SHOWN))
    _finish(figure, panels[0], path)


def draw_all(ablation: Ablation, path: Path) -> None:
    """Writes the curves of all settings as PNG."""
    figure = Figure(figsize=(12, 6.4), dpi=_DPI, layout="constrained")
    columns = len(SETTINGS) // 4
    panels = figure.subplots(4, columns, sharex=True, sharey=True)
    for axes, setting in zip(panels.flat, SETTINGS, strict=True):
        _draw(axes, ablation.of(setting), setting)
    for axes in panels[-1]:
        axes.set_xlabel("epoch")
    panels[0, 0].set_ylim(0, _highest(ablation, SETTINGS))
    _finish(figure, panels[0, 0], path)


def title(setting: Setting) -> str:
    """Names a setting in a figure."""
    com = "COM" if setting.use_com else "no COM"
    shape = setting.shape
    return (
        f"model {setting.model}, {com}\n{shape.layers} layers, "
        f"patch {shape.patch_size}, {setting.heads} heads"
    )


def _draw(axes: Axes, trainings: Sequence[Training], setting: Setting) -> None:
    """Draws the mean over the seeds, and a band from the least to the greatest."""
    for label, colour, error in _CURVES:
        curves = 100 * np.array([[error(epoch) for epoch in one.epochs] for one in trainings])
        epochs = np.arange(1, curves.shape[1] + 1)
        axes.fill_between(epochs, curves.min(axis=0), curves.max(axis=0), color=colour, alpha=0.2)
        axes.plot(epochs, curves.mean(axis=0), color=colour, label=label, marker=".", markersize=4)
    axes.set_title(title(setting), fontsize=9)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)


def _highest(ablation: Ablation, settings: Sequence[Setting]) -> float:
    """The top of the axes, cm: over all of validation; training begins far above it."""
    return 110 * max(
        max(epoch.held_out_error, epoch.validation_error)
        for setting in settings
        for training in ablation.of(setting)
        for epoch in training.epochs
    )


def _finish(figure: Figure, first: Axes, path: Path) -> None:
    figure.supylabel("error of the keypoint, cm", fontsize=10)
    handles, labels = first.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=_DPI, format="png", facecolor="white")
