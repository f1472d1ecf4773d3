"""Looks at the processes of a command that runs in a group of its own."""

import time
from collections.abc import Iterator
from pathlib import Path


def processes_of_group(group: int) -> Iterator[int]:
    """Yields the processes of a group that run."""
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _parent, owner = stat.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue  # It ended while we looked.
        if int(owner) == group and state != "Z":
            yield int(stat.parent.name)


def workers_of_group(group: int) -> list[int]:
    """Returns those that run blocks."""
    return [pid for pid in processes_of_group(group) if b"spawn_main" in _command_line(pid)]


def wait_for_end(group: int, seconds: float = 60) -> None:
    """Waits until no process of a group is left."""
    end = time.monotonic() + seconds
    while list(processes_of_group(group)):
        assert time.monotonic() < end, f"still there: {list(processes_of_group(group))}"
        time.sleep(0.05)


def _command_line(pid: int) -> bytes:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""
