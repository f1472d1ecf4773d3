"""Pictures of objects: one alone, and many on a sheet, with the centre of mass marked."""

import io
import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from keypush.objects.model import ObjectModel
from keypush.objects.picture import Image, View, pixel_of, render_mesh

_PICTURE = 240
_DPI = 100
_LABEL = 0.14
"""Height of a label as a share of a picture's."""
_COM_MARK = (("white", 7.5), ("#d8163a", 4.5))
"""Colours and diameters of the dots on the centre of mass, the lower first."""


def render_picture(model: ObjectModel, size: int = 640) -> bytes:
    """Returns a picture of one object as PNG."""
    return render_sheet([(model, model.name.replace("_", " "))], columns=1, size=size)


def render_sheet(
    objects: Sequence[tuple[ObjectModel, str]], columns: int = 8, size: int = _PICTURE
) -> bytes:
    """Returns pictures of objects as one PNG.

    Args:
        objects: models and what stands below each.
        columns: pictures in a row.
        size: width and height of a picture in pixels.
    """
    columns = min(columns, len(objects))
    rows = -(-len(objects) // columns)
    figure = Figure(figsize=(columns * size / _DPI, rows * (1 + _LABEL) * size / _DPI), dpi=_DPI)
    FigureCanvasAgg(figure)
    view = View(size=(size, size))
    for k, ((model, label), image) in enumerate(zip(objects, _render(objects, view), strict=True)):
        row, column = divmod(k, columns)
        height = 1 / (1 + _LABEL) / rows
        left, bottom = column / columns, 1 - (row + 1) / rows + (1 / rows - height)
        axes = figure.add_axes((left, bottom, 1 / columns, height))
        _draw(axes, model, view, image)
        figure.text(
            left + 0.5 / columns, bottom - 0.25 * (1 / rows - height), label,
            ha="center", va="top", fontsize=11,
        )  # fmt: skip
    file = io.BytesIO()
    figure.savefig(file, dpi=_DPI, format="png", facecolor="white")
    return file.getvalue()


def _render(objects: Sequence[tuple[ObjectModel, str]], view: View) -> list[Image]:
    """Renders in another process: after VTK has run in one, importing torch's triton crashes it."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        waiting = [
            pool.submit(render_mesh, model.visual, model.colour[:3], view) for model, _ in objects
        ]
        return [future.result() for future in waiting]


def _draw(axes: Axes, model: ObjectModel, view: View, image: Image) -> None:
    axes.imshow(image)
    x, y = pixel_of(model.p_OoOcm_O, model.visual, view)
    for colour, diameter in _COM_MARK:
        axes.plot(x, y, "o", markersize=diameter, color=colour, markeredgewidth=0)
    axes.set_axis_off()
