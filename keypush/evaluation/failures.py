"""Pages to watch of episodes that failed."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
from tqdm import tqdm

from keypush.atomic_file import write_whole
from keypush.evaluation.conditions import condition_name
from keypush.evaluation.evaluate import condition_folders
from keypush.recording.recorder import record_episode
from keypush.rollout.job import Job
from keypush.scenario import Scenario

RECORDINGS = "recordings"


def record_failures(jobs: Sequence[Job], records: pa.Table, out: Path, most: int) -> list[Path]:
    """Runs the first failed episodes of every object and condition again and records them.

    An episode repeats bit for bit, so the page shows the episode that was evaluated. Pages that
    are there already are kept.

    Args:
        jobs: as they were evaluated.
        records: of their episodes.
        out: folder of the evaluation.
        most: pages per object and condition.

    Returns:
        The pages: OUT/recordings/OBJECT-EPISODE.html, where there are several conditions with
        the name of the condition after that.

    Raises:
        UserError: a page cannot be written.
        RuntimeError: the simulation failed, or no port is free.
    """
    scenarios = dict(zip(condition_folders(jobs), (job.scenario for job in jobs), strict=True))
    pages = []
    for folder, name, episode in _choose(records, most):
        scenario = scenarios[folder]
        condition = f"-{condition_name(scenario)}" if len(jobs) > 1 else ""
        path = out / RECORDINGS / f"{name}-{episode}{condition}.html"
        pages.append((scenario, name, episode, path))
    for scenario, name, episode, path in tqdm(pages, unit="recordings", disable=None):
        if not path.exists():
            _record(scenario, name, episode, path)
    return [path for *_, path in pages]


def _choose(records: pa.Table, most: int) -> list[tuple[str, str, int]]:
    taken: Counter[tuple[str, str]] = Counter()
    chosen = []
    for record in records.select(["folder", "object", "episode", "success"]).to_pylist():
        where = record["folder"], record["object"]
        if not record["success"] and taken[where] < most:
            taken[where] += 1
            chosen.append((*where, record["episode"]))
    return chosen


def _record(scenario: Scenario, name: str, episode: int, path: Path) -> None:
    mine = replace(scenario, object=replace(scenario.object, name=name))
    html = record_episode(mine, episode).html
    write_whole(path, html.encode())
