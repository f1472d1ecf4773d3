"""What differs between the runs of a report beside what it compares."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa

from keypush.reporting.runs import RUN
from keypush.reporting.settings import read_settings

_COMPARED = {
    "policy", "predictor.weights", "seed", "object.name", "object.size_ratio", "variation.size",
    "variation.com_shift", "noise.cloud_deviation", "planner.push_speed",
}  # fmt: skip
"""Fields of the scenario that a report tells of anyway."""
_FILES = {"weights_sha256": "weights", "policy_sha256": "file"}
"""What lies in files that have one name and may have had two contents."""
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
    folders = dict.fromkeys(zip(table[RUN].to_pylist(), table["folder"].to_pylist(), strict=True))
    found: dict[str, dict[str, None]] = {}
    for run, folder in folders:
        for name, value in _settings(Path(run) / folder):
            found.setdefault(name, {})[value] = None
    unlike = [f"{name} ({', '.join(values)})" for name, values in found.items() if len(values) > 1]
    if not unlike:
        return ""
    more = f" and {len(unlike) - _MOST} more" if len(unlike) > _MOST else ""
    return f"these runs also differ in {', '.join(unlike[:_MOST])}{more}"


def _settings(folder: Path) -> Iterator[tuple[str, str]]:
    scenario, job = (read_settings(folder / name) for name in ("scenario.yaml", "job.yaml"))
    if "keypush" in job:
        yield "keypush", str(job["keypush"])
    for name, what in _FILES.items():
        if name in job:
            yield f"{what} of {_driver(scenario)}", str(job[name])[:8]
    for name, value in scenario.items():
        if name not in _COMPARED:
            yield name, str(value)


def _driver(scenario: dict[str, Any]) -> str:
    policy, weights = scenario.get("policy"), scenario.get("predictor.weights", "auto")
    return f"{policy}{'' if weights == 'auto' else f' with {weights}'}"
