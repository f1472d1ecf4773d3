"""Every notebook runs as it is, shows what it promises, and is stored without what it printed."""

import ast
from collections.abc import Iterator
from html import escape
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from keypush.systems.episode_monitor import Outcome

FOLDER = Path(__file__).parents[2] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
RECORDINGS = {"collect_train_watch": 2, "data_set": 0, "evaluate": 2, "own_mesh": 1, "station": 2}
"""How many recordings each notebook plays."""
STILL_PAGES = {"evaluate": 1, "own_mesh": 1}
"""How many pages that do not play it shows besides: a report, an object."""
TIME_BAR = escape('<div id="keypush-time"')
BLANK_PICTURE = 12_000
"""Axes with labels and nothing in them make about 10 000 characters of PNG in base64."""


def test_there_are_notebooks() -> None:
    assert {path.stem for path in NOTEBOOKS} == RECORDINGS.keys()


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(path: Path) -> None:
    cells = nbformat.read(path, as_version=4).cells
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


def test_every_outcome_has_a_colour() -> None:
    """One that the notebook's own policies never have would end it where a reader's has it."""
    cells = nbformat.read(FOLDER / "evaluate.ipynb", as_version=4).cells
    statements = next(
        ast.parse(cell.source).body for cell in cells if cell.source.startswith("colours = ")
    )
    assert isinstance(statements[0], ast.Assign)
    colours = ast.literal_eval(statements[0].value)
    assert {Outcome[name.upper()] for name in colours} == set(Outcome) - {Outcome.RUNNING}
    assert len(set(colours.values())) == len(colours)


@pytest.mark.timeout(600)  # they take half a minute; a busy machine may starve them
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(notebook, timeout=None, kernel_name="python3",
                            resources={"metadata": {"path": FOLDER}})  # fmt: skip
    client.execute()
    pictures = list(_shown(notebook, "image/png"))
    assert pictures
    assert all(len(picture) > BLANK_PICTURE for picture in pictures)
    frames = [page for page in _shown(notebook, "text/html") if page.startswith("<iframe srcdoc=")]
    recordings = [page for page in frames if TIME_BAR in page]
    assert len(recordings) == RECORDINGS[path.stem]
    assert len(frames) - len(recordings) == STILL_PAGES.get(path.stem, 0)


def _shown(notebook: nbformat.NotebookNode, kind: str) -> Iterator[str]:
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            if kind in output.get("data", {}):
                yield output["data"][kind]
