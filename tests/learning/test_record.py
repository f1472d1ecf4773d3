"""What cards tell of the machine on which weights were trained: nothing."""

from pathlib import Path

import pytest

from keypush.learning.record import command_line


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
