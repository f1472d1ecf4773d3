"""What a terminal shows while episodes are collected."""

import fcntl
import os
import pty
import struct
import subprocess
import termios
from pathlib import Path

from tests.cli.command import KEYPUSH

ARGUMENTS = (
    "collect", "--objects", "plate", "--episodes-per-object", "11", "--workers", "1",
    "--set", "episode.max_steps=3", "--out",
)  # fmt: skip


def test_estimate_and_bar(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 140, 0, 0))
    process = subprocess.Popen(
        [KEYPUSH, *ARGUMENTS, tmp_path], stdout=subprocess.DEVNULL, stderr=theirs
    )
    os.close(theirs)
    lines = _read(ours).replace("\r", "\n").splitlines()
    assert process.wait(timeout=60) == 0
    shown = [line for line in lines if line]
    assert shown[0].startswith("keypush: 11 of 11 episodes to run: about 7 s with 1 worker, 0.4 MB")
    bars = [line for line in shown if "11/11" in line]
    for words in ("100%", " left, ", "episodes/s", "success 0.0%", "MB of about"):
        assert words in bars[-1]


def _read(terminal: int) -> str:
    """Reads what a terminal gets until nobody has it open."""
    content = b""
    while True:
        try:
            content += os.read(terminal, 4096)
        except OSError:  # What Linux says where a pipe would be at its end.
            os.close(terminal)
            return content.decode()
