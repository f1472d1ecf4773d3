"""The process that imports: its limits, its death, and that it leaves nothing behind."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from keypush.errors import UserError
from keypush.objects.importing.process import Importer, import_mesh
from tests.objects.importing.mutate import export


@pytest.fixture
def big(tmp_path: Path) -> Path:
    """A file that takes a second or more to read."""
    return export(trimesh.creation.icosphere(subdivisions=7), tmp_path / "big", "stl")


@pytest.fixture
def bowl(tmp_path: Path) -> Path:
    """A file that takes a second or more to repair."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.update_faces(mesh.triangles_center[:, 2] < 0)
    return export(mesh, tmp_path / "bowl", "ply")


def signal_the_child(number: signal.Signals) -> None:
    child = multiprocessing.active_children()[0]
    assert child.pid is not None
    os.kill(child.pid, number)


def test_one_call_imports_one_file(bowl: Path, capfd: pytest.CaptureFixture[str]) -> None:
    result = import_mesh(bowl)
    assert result.solid.volume > 0
    assert len(result.sha256) == 64
    assert not multiprocessing.active_children()
    assert capfd.readouterr() == ("", "")


def test_a_file_that_takes_too_long_is_refused(big: Path) -> None:
    with pytest.raises(UserError, match=r"big.stl: cannot be read as a mesh: .*took longer than"):
        import_mesh(big, time_limit=0.01)
    assert not multiprocessing.active_children()


def test_where_repairing_takes_too_long_the_hull_does(bowl: Path) -> None:
    with Importer(repair_seconds=0.0) as importer:
        result = importer.import_mesh(bowl)
    assert result.solid.is_watertight
    assert result.solid.volume == pytest.approx(result.solid.convex_hull.volume)
    assert "the solid is the convex hull" in result.notes[-2]
    assert result.notes[-1] == "repairing it took longer than 0 s"


@pytest.mark.slow
def test_time_in_which_the_machine_does_other_things_does_not_count(bowl: Path) -> None:
    with Importer(repair_seconds=5.0) as importer:
        expected = importer.import_mesh(bowl)
        timers = [
            threading.Timer(seconds, signal_the_child, [number])
            for seconds, number in ((0.1, signal.SIGSTOP), (6.0, signal.SIGCONT))
        ]
        for timer in timers:
            timer.start()
        begun = time.monotonic()
        result = importer.import_mesh(bowl, time_limit=5.0)
        assert time.monotonic() - begun > 5.0
        for timer in timers:
            timer.join()
    assert result.notes == expected.notes
    np.testing.assert_array_equal(result.solid.vertices, expected.solid.vertices)


def test_a_crash_while_reading_is_one_line_and_the_next_file_is_imported(
    big: Path, bowl: Path
) -> None:
    with Importer() as importer:
        importer.import_mesh(bowl)
        timer = threading.Timer(0.1, signal_the_child, [signal.SIGSEGV])
        timer.start()
        with pytest.raises(UserError) as caught:
            importer.import_mesh(big)
        timer.join()
        assert str(caught.value) == (
            f"{big}: cannot be read as a mesh: reading it crashed a library (SIGSEGV)"
        )
        assert importer.import_mesh(bowl).solid.volume > 0
    assert not multiprocessing.active_children()


SCRIPT = """
import sys
from pathlib import Path
from keypush.objects.importing.process import import_mesh

if __name__ == "__main__":
    print("begin", flush=True)
    import_mesh(Path(sys.argv[1]))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_no_process(number: signal.Signals, big: Path, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    with subprocess.Popen(
        [sys.executable, script, big],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        env=os.environ | {"PYTHONPATH": str(Path.cwd())},
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(1.5)
        # SIGINT as a terminal sends it, to all; SIGTERM to the parent alone.
        if number == signal.SIGINT:
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
        process.wait(20)
    end = time.monotonic() + 60
    while members(process.pid) and time.monotonic() < end:
        time.sleep(0.1)
    assert not members(process.pid)


def members(session: int) -> list[str]:
    """Returns the processes of a session that still run."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            text = (folder / "stat").read_text()
        except OSError:
            continue
        state, *fields = text.rsplit(")", 1)[1].split()
        if int(fields[2]) == session and state != "Z":
            found.append(text)
    return found


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_million_faces(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=8)
    noise = 1 + 0.002 * np.random.default_rng(0).normal(size=(len(ball.vertices), 1))
    ball.vertices = ball.vertices * noise
    result = import_mesh(export(ball, tmp_path / "big", "stl"), time_limit=240.0)
    assert result.solid.is_watertight
    assert result.solid.volume == pytest.approx(4 / 3 * np.pi, rel=0.01)
