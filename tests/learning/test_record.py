"""What cards tell of the machine on which weights were trained: nothing."""

import shutil
import subprocess
from pathlib import Path

import pytest

from keypush.learning import record
from keypush.learning.record import command_line, git_revision


def test_a_command_has_no_path_of_the_machine(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["/usr/bin/keypush", "train", "--data", f"{tmp_path}/runs/data", "--out", "/else/out"]
    monkeypatch.setattr("sys.argv", [*words, "--encoder", "runs/contact.safetensors"])
    assert command_line() == [
        "keypush", "train", "--data", "runs/data", "--out", "out",
        "--encoder", "runs/contact.safetensors",
    ]  # fmt: skip


def test_the_revision_is_that_of_the_code_and_not_of_a_checkout_around_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    own = Path(record.__file__)
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    shutil.copy(own, tmp_path)
    who = ["-c", "user.name=a", "-c", "user.email=a@b"]
    commit = ["git", "-C", str(tmp_path), *who, "commit", "-q", "-m", "theirs"]
    subprocess.run([*commit, "--allow-empty"], check=True)
    monkeypatch.setattr(record, "__file__", str(tmp_path / own.name))
    assert git_revision() == "unknown"
    subprocess.run(["git", "-C", tmp_path, "add", own.name], check=True)
    subprocess.run(commit, check=True)
    assert len(git_revision()) == 40
