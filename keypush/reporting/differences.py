"""What differs between the runs of a report beside what it compares."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from keypush.dataset.job_file import USER_OBJECTS
from keypush.objects.library import USER_GROUP
from keypush.reporting.runs import RUN
from keypush.reporting.settings import read_settings

_COMPARED = {
    "policy", "predictor.weights", "seed", "object.name", "object.size_ratio", "variation.size",
    "variation.com_shift", "noise.cloud_deviation", "planner.push_speed",
}  # fmt: skip
"""Fields of the scenario that a report tells of anyway."""
_FILES = {"weights_sha256": "weights", "policy_sha256": "file"}
"""What lies in files that have one name and may have had two contents."""
_MISSING = "missing"
_MOST = 6
"""So many differences are named."""


def find_differences(table: pa.Table) -> str:
    """Says, on one line, how the runs differ in keypush's version and in fields not compared.

    Args:
        table: what `read_runs` returned; folders without scenario.yaml and job.yaml, such as
            records that were moved alone, say nothing.

    Returns:
        The line; empty where all are alike.
    """
    found: dict[str, dict[str, None]] = {}
    scenarios = []
    for folder, own in _folders(table).items():
        scenario, job = (read_settings(folder / name) for name in ("scenario.yaml", "job.yaml"))
        for name, value in _made_by(scenario, job, own):
            found.setdefault(name, {})[value] = None
        if scenario:
            scenarios.append(scenario)
    # A field that only newer versions have is a difference, too.
    for name in dict.fromkeys(name for scenario in scenarios for name in scenario):
        if name not in _COMPARED:
            found[name] = {str(scenario.get(name, _MISSING)): None for scenario in scenarios}
    unlike = [f"{name} ({', '.join(values)})" for name, values in found.items() if len(values) > 1]
    if not unlike:
        return ""
    more = f" and {len(unlike) - _MOST} more" if len(unlike) > _MOST else ""
    return f"these runs also differ in {', '.join(unlike[:_MOST])}{more}"


def _folders(table: pa.Table) -> dict[Path, list[str]]:
    """Where episodes lie, and which own objects were pushed in those of each folder."""
    kinds = table.group_by([RUN, "folder", "set", "object"], use_threads=False).aggregate([])
    found: dict[Path, list[str]] = {}
    for kind in kinds.to_pylist():
        own = found.setdefault(Path(kind[RUN]) / kind["folder"], [])
        if kind["set"] == USER_GROUP:
            own.append(kind["object"])
    return found


def _made_by(
    scenario: Mapping[str, Any], job: Mapping[str, Any], own: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """What made the episodes of a folder: the version, and what lies in files."""
    if "keypush" in job:
        yield "keypush", str(job["keypush"])
    for name, what in _FILES.items():
        if name in job:
            yield f"{what} of {_driver(scenario)}", _short(job[name])
    # One digest of all own objects: compared between jobs that have the same ones.
    if own and USER_OBJECTS in job:
        yield f"files of {', '.join(sorted(own))}", _short(job[USER_OBJECTS])


def _short(digest: Any) -> str:
    return str(digest)[:8]


def _driver(scenario: Mapping[str, Any]) -> str:
    policy, weights = scenario.get("policy"), scenario.get("predictor.weights", "auto")
    return f"{policy}{'' if weights == 'auto' else f' with {weights}'}"
