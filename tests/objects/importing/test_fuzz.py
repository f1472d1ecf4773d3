"""Every file, however broken, gives a closed solid or one line that says why not."""

import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from manifold3d import Error, Manifold, Mesh64

from keypush.errors import UserError
from keypush.objects.importing.process import Importer
from tests.objects.importing.mutate import fuzz_files

SECONDS = 30.0
"""A file that takes this long hangs, on a machine that is busy with other things."""


def check(importer: Importer, path: Path) -> str:
    """Imports a file and says what became of it."""
    try:
        result = importer.import_mesh(path, time_limit=SECONDS)
    except UserError as error:
        text = str(error)
        assert text.startswith(str(path)), text
        assert len(text.splitlines()) == 1, text
        assert "crashed" not in text, text
        assert "took longer" not in text, text
        return "refused"
    solid = result.solid
    judged = Manifold(Mesh64(np.asarray(solid.vertices), solid.faces.astype(np.uint64)))
    assert judged.status() == Error.NoError
    assert judged.volume() > 0
    assert solid.is_watertight
    assert len(solid.faces) <= 4000
    assert not [note for note in result.notes if note.startswith("repairing it")], result.notes
    return "solid"


def fuzz(count: int, folder: Path) -> Counter[str]:
    """Imports files in one process; prints the slowest."""
    outcomes: Counter[str] = Counter()
    slowest = (0.0, "")
    with Importer() as importer:
        for path in fuzz_files(count, folder):
            start = time.monotonic()
            outcomes[check(importer, path)] += 1
            slowest = max(slowest, (time.monotonic() - start, str(path)))
    print(f"{dict(outcomes)}, slowest {slowest[0]:.1f} s: {slowest[1]}")  # noqa: T201  # shown by -s
    return outcomes


def test_thirty_broken_files(tmp_path: Path) -> None:
    outcomes = fuzz(30, tmp_path)
    assert outcomes["solid"] >= 10
    assert outcomes["refused"] >= 5


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_five_hundred_broken_files(tmp_path: Path) -> None:
    outcomes = fuzz(500, tmp_path)
    assert outcomes["solid"] >= 200
    assert outcomes["refused"] >= 100


def test_files_are_the_same_every_time(tmp_path: Path) -> None:
    first = [path.read_bytes() for path in fuzz_files(27, tmp_path / "a")]
    second = [path.read_bytes() for path in fuzz_files(27, tmp_path / "b")]
    assert first == second
