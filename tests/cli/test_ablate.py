"""`keypush ablate` as a user runs it."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from keypush.cli.main import main
from keypush.learning.ablation.results import read_ablation
from tests.cli.command import KEYPUSH
from tests.cli.processes import wait_for_end
from tests.learning.ablation.sample import write_small_data

SHORT = [
    "--seeds", "0", "--workers", "2", "--head.rows-per-object", "8", "--head.epochs", "2",
    "--head.batch", "32", "--head.clouds-per-object", "2", "--pretraining.epochs", "1",
    "--pretraining.samples-per-epoch", "64", "--pretraining.batch", "32",
    "--pretraining.clouds-per-object", "2", "--pretraining.validation-samples", "16",
]  # fmt: skip


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_small_data(tmp_path_factory.mktemp("data"), episodes=2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--data", "nothing"], "--data nothing: no such folder; allowed: one of"),
        (["--workers", "0"], "--workers is 0; allowed: 1 or more"),
        (["--report", "page.html"], "--report page.html: allowed: a file that ends in .md"),
        (["--seeds", "1", "1"], "seeds is 1 1; allowed: whole numbers"),
        (["--head.heads", "16"], "head.heads is 16; allowed: 8, because the ablation sets it"),
        (["--head.no-cache"], "head.cache is False; allowed: True, because"),
        (["--pretraining.encoder.layers", "3"], "pretraining.encoder.layers is 3; allowed: 2"),
        (["--held-out-objects", "bowl", "bowl"], "has bowl twice; allowed: each once"),
        (["--held-out-objects", "kettle"], "held_out_objects has kettle; allowed: block, book"),
    ],
)
def test_mistakes_are_named(
    arguments: list[str],
    message: str,
    data: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["ablate", "--data", str(data), "--out", str(tmp_path / "o"), *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def _start(data: Path, out: Path) -> "subprocess.Popen[str]":
    paths = ["--data", str(data), "--out", str(out)]
    command = [str(KEYPUSH), "ablate", *paths, *SHORT, "--preset", "thesis"]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_a_run_that_was_stopped_ends_with_the_same_records(data: Path, tmp_path: Path) -> None:
    stopped, whole = tmp_path / "stopped", tmp_path / "whole"
    for how, what in ((signal.SIGKILL, "encoders/*/contact.json"), (signal.SIGINT, "records/*")):
        process = _start(data, stopped)
        while not list(stopped.glob(what)):
            assert process.poll() is None
            time.sleep(0.01)
        os.kill(process.pid, how)
        _, errors = process.communicate(timeout=60)
        assert process.returncode == (130 if how == signal.SIGINT else -how)
        assert "Traceback" not in errors
        wait_for_end(process.pid)
        assert not (stopped / "ablation.json").exists()
    for out in (stopped, whole):
        process = _start(data, out)
        told, errors = process.communicate(timeout=600)
        assert process.returncode == 0, errors
        assert "with the centre of mass the best is model" in told
        assert f"written: {out / 'ablation.md'}" in told
    assert read_ablation(stopped).trainings == read_ablation(whole).trainings
    assert {path.name for path in whole.iterdir()} == {
        "ablation.json", "ablation.md", "ablation_best.png", "ablation_all.png", "encoders",
        "heads", "records", "settings.json",
    }  # fmt: skip
