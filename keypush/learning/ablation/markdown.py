"""How the page writes numbers, settings, paragraphs and tables."""

import math
import textwrap
from collections.abc import Callable, Iterable, Sequence
from statistics import fmean

from keypush.learning.ablation.effects import deviation
from keypush.learning.ablation.results import Epoch, Training
from keypush.learning.ablation.settings import Setting

_WIDTH = 116


def variant(*, use_com: bool) -> str:
    """Names one half of the settings."""
    return "with the centre of mass" if use_com else "without the centre of mass"


def describe(setting: Setting) -> str:
    """Names a setting within its half."""
    shape = setting.shape
    return (
        f"model {setting.model} ({shape.layers} layers, patches of {shape.patch_size}, "
        f"{setting.heads} heads)"
    )


def centimetres(values: Sequence[float]) -> str:
    """Returns the mean of values in m and, of several, their standard deviation."""
    spread = deviation(values)
    told = "" if math.isnan(spread) else f" ± {100 * spread:.3f}"
    return f"{100 * fmean(values):.3f}{told}"


def mean_curve(trainings: Sequence[Training], value: Callable[[Epoch], float]) -> list[float]:
    """Returns the mean over trainings, epoch by epoch."""
    epochs = zip(*(training.epochs for training in trainings), strict=True)
    return [fmean(map(value, same)) for same in epochs]


def paragraph(text: str) -> str:
    """Breaks a text into lines."""
    return textwrap.fill(
        " ".join(text.split()), _WIDTH, break_long_words=False, break_on_hyphens=False
    )


def table(head: Iterable[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns a Markdown table."""
    lines = [list(head), *rows]
    marked = [f"| {' | '.join(line)} |" for line in lines]
    return "\n".join([marked[0], "|" + " --- |" * len(lines[0]), *marked[1:]])
