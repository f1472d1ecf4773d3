"""How long an evaluation really took, over all its stops."""

import json
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from keypush.atomic_file import write_whole
from keypush.errors import UserError, one_line
from keypush.rollout.job import Job
from keypush.rollout.store import finished_episodes

TIMING_FILE = "timing.json"
_ALLOWED = "allowed: the file as it was written, or none"
_WHOLE, _POSITIVE = ((int,), "a positive whole number"), ((int, float), "a positive number")
_KINDS: Mapping[str, tuple[tuple[type, ...], str]] = {
    "episodes": _WHOLE, "seconds": _POSITIVE, "workers": _WHOLE,
}  # fmt: skip
"""Fields of a session in the file: their types and what is allowed."""


@dataclass(frozen=True, kw_only=True)
class Session:
    """One start of the command that finished episodes."""

    episodes: int
    """That were finished."""
    seconds: float
    """From the start of the workers to their end; also what was spent on unfinished episodes."""
    workers: int


@contextmanager
def timed(job: Job, folder: Path, workers: int) -> Iterator[None]:
    """Adds the session that runs inside to `timing.json`, however it ends.

    Raises:
        UserError: the file is damaged or cannot be written.
    """
    sessions = read_sessions(folder)
    before, began = finished_episodes(job, folder), time.monotonic()
    try:
        yield
    finally:
        episodes, seconds = finished_episodes(job, folder) - before, time.monotonic() - began
        if episodes:
            session = Session(episodes=episodes, seconds=seconds, workers=workers)
            _write([*sessions, session], folder)


def read_sessions(out: Path) -> list[Session]:
    """Reads the sessions of an evaluation so far.

    Raises:
        UserError: the file is damaged.
    """
    path = out / TIMING_FILE
    if not path.exists():
        return []
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read: {one_line(error)}; {_ALLOWED}") from error
    entries = found.get("sessions") if isinstance(found, dict) else None
    if not isinstance(entries, list):
        raise UserError(f"{path}: has no list of sessions; {_ALLOWED}")
    return [_session(entry, f"{path}: session {number}") for number, entry in enumerate(entries, 1)]


def _session(entry: Any, where: str) -> Session:
    """Makes a session of what a file holds, which somebody may have edited."""
    if not isinstance(entry, dict) or set(entry) != set(_KINDS):
        raise UserError(f"{where} is {entry!r}; {_ALLOWED}, with {', '.join(_KINDS)}")
    for name, (kinds, words) in _KINDS.items():
        value = entry[name]
        if type(value) not in kinds or not 0 < value < math.inf:
            raise UserError(f"{where}: {name} is {value!r}; allowed: {words}")
    return Session(**entry)


def rate(sessions: Sequence[Session]) -> float | None:
    """Returns episodes per second over all sessions; None without any."""
    seconds = sum(session.seconds for session in sessions)
    return sum(session.episodes for session in sessions) / seconds if seconds else None


def _write(sessions: Sequence[Session], out: Path) -> None:
    content = {"sessions": [asdict(session) for session in sessions]}
    write_whole(out / TIMING_FILE, (json.dumps(content, indent=1) + "\n").encode())
