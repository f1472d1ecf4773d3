"""What the rows of an episode say of it, and its record."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from keypush.dataset.arrays import to_array
from keypush.learning.policy_model import policy_weights
from keypush.objects.listing import split_of
from keypush.planning.plan_state import Stage
from keypush.policies import find_policy
from keypush.rollout.job import Block, Job
from keypush.rollout.shard import read_shard
from keypush.scenario import Scenario

_COLUMNS = ["episode", "stage", "object_pose", "tool_pose", "goal", "contact_point", "target"]
_TOLD = ["policy", "object", "size_ratio", "com_capped", "seed", "episode", "success",
         "settled_success", "outcome", "steps"]  # fmt: skip
"""Columns of `episodes/` that a record repeats."""


def job_records(job: Job, folder: Path, name: str) -> Iterator[dict[str, Any]]:
    """Yields the record of every episode of a finished job, by object and episode.

    Args:
        job: has been run.
        folder: the job's.
        name: of the folder, in the records.
    """
    shared = _shared(job.scenario, name)
    for block in job.blocks():
        yield from _block_records(block, folder, shared)


def measure_rows(rows: Mapping[str, NDArray[Any]]) -> dict[str, float]:
    """Measures one episode; `docs/evaluation.md` defines what.

    Args:
        rows: columns of `rows/`: stage (n,), object_pose and tool_pose (n, 7), goal (n, 2),
            contact_point and target (n, 3).

    Returns:
        object_path, tool_path, keypoint_error (NaN where nothing was pushed at a keypoint),
        start_x, start_y, goal_x and goal_y, m.
    """
    p_WO, p_WE = rows["object_pose"][:, 4:], rows["tool_pose"][:, 4:]
    start, goal = p_WO[0], rows["goal"][0]
    return {
        "object_path": _length(p_WO[:, :2]),
        "tool_path": _length(p_WE),
        "keypoint_error": _keypoint_error(rows["stage"], rows["target"], rows["contact_point"]),
        "start_x": float(start[0]),
        "start_y": float(start[1]),
        "goal_x": float(goal[0]),
        "goal_y": float(goal[1]),
    }


def _length(path: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def _keypoint_error(
    stage: NDArray[np.integer], target: NDArray[np.float64], contact: NDArray[np.float64]
) -> float:
    distance = np.linalg.norm(target - contact, axis=1)[stage == Stage.PUSH]
    measured = distance[np.isfinite(distance)]
    return float(measured.mean()) if len(measured) else float("nan")


def _block_records(
    block: Block, folder: Path, shared: Mapping[str, Any]
) -> Iterator[dict[str, Any]]:
    file = f"{block.name}.parquet"
    table = read_shard(folder / "rows" / file, _COLUMNS)
    columns = {name: to_array(table[name]) for name in _COLUMNS}
    summaries = read_shard(folder / "episodes" / file, _TOLD)
    # Only who may fail has a column for the reason.
    wanted = [name for name in (*_TOLD, "reason") if name in summaries.column_names]
    for told in summaries.select([*wanted, "final_position"]).to_pylist():
        mine = columns["episode"] == told["episode"]
        x, y, _ = told.pop("final_position")
        measured = measure_rows({name: column[mine] for name, column in columns.items()})
        known = {**shared, **told, "set": split_of(block.object)}
        yield {**known, **measured, "final_x": x, "final_y": y}


def _shared(scenario: Scenario, folder: str) -> dict[str, Any]:
    return {
        "reason": "",
        "weights": _weights_file(scenario),
        "com_shift": scenario.variation.com_shift,
        "cloud_deviation": scenario.noise.cloud_deviation,
        "push_speed": scenario.planner.push_speed,
        "folder": folder,
    }


def _weights_file(scenario: Scenario) -> str:
    if find_policy(scenario.policy).weights_kind is None:
        return ""
    path, _ = policy_weights(scenario.policy, scenario.predictor.weights)
    return path.name
