"""Made-up records of evaluations: the columns of real ones, outcomes drawn at given rates."""

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from keypush.evaluation.records import RECORDS, RECORDS_FILE, write_records
from keypush.reporting.episodes import Episodes, gather_episodes
from keypush.reporting.runs import read_runs
from keypush.seeding import make_generator

Record = dict[str, Any]

OBJECTS = {
    "block": "train", "bottle": "train", "mug": "train", "telephone": "train",
    "can_2": "id", "candle": "id", "plate": "ood", "tripod": "ood", "twisted_prism": "ood",
}  # fmt: skip
RATES = {"expert": 0.98, "surface_no_com": 0.92, "behavior_cloning": 0.45, "centroid": 0.35}
CONDITIONS = [*({"size_ratio": size} for size in (1.0, 0.75, 0.875, 1.125, 1.25)),
              {"com_shift": 0.015}]  # fmt: skip
VARIED = ("policy", "size_ratio", "com_shift", "cloud_deviation", "push_speed")
_FAILURES = ("toppled", "fell", "timed_out")
_NO_KEYPOINT = ("behavior_cloning",)


def record(**values: object) -> Record:
    """One successful nominal episode of the expert with the mug, but for what is given."""
    plain = {
        "policy": "expert", "weights": "", "object": "mug", "set": "train", "size_ratio": 1.0,
        "com_shift": 0.0, "com_capped": False, "cloud_deviation": 0.005, "push_speed": 0.065,
        "seed": 0, "episode": 0, "success": True, "settled_success": True, "outcome": "success",
        "reason": "", "steps": 80, "object_path": 0.2, "tool_path": 0.6, "keypoint_error": 0.004,
        "start_x": 0.05, "start_y": -0.1, "goal_x": -0.05, "goal_y": 0.1, "final_x": -0.03,
        "final_y": 0.09, "folder": ".",
    }  # fmt: skip
    assert list(plain) == RECORDS.names
    assert set(values) <= set(plain)
    made = {**plain, **values}
    if "folder" not in values:  # every condition has a folder of its own
        made["folder"] = "-".join(str(made[name]) for name in VARIED)
    return made


def failed(**values: object) -> Record:
    """The same, toppled."""
    return record(**{"success": False, "settled_success": False, "outcome": "toppled", **values})


def many_records(
    rates: Mapping[str, float] = RATES,
    objects: Mapping[str, str] = OBJECTS,
    conditions: Sequence[Mapping[str, float]] = CONDITIONS,
    episodes: int = 8,
) -> list[Record]:
    """An evaluation of several policies on the same episodes."""
    return [
        _draw(policy, rate, name, objects[name], episode, condition)
        for policy, rate in rates.items()
        for condition, name, episode in product(conditions, objects, range(episodes))
    ]


def _draw(
    policy: str, rate: float, name: str, of_set: str, episode: int, condition: Mapping[str, float]
) -> Record:
    purpose = f"{policy} {name} {sorted(condition.items())}"
    rng = make_generator(0, episode, purpose)
    start, goal = (make_generator(0, episode, end).uniform(-1, 1, 2) * (0.16, 0.2)
                   for end in ("start", "goal"))  # fmt: skip
    error = rng.gamma(2.0, 0.004 + 0.02 * (1 - rate))
    won = rng.random() < rate * (1 - 4 * error)
    final = goal + rng.normal(0, 0.02, 2) if won else start
    distance = float(np.linalg.norm(final - start))
    return record(
        **condition, policy=policy, weights=f"{policy}.safetensors" if rate == 0.92 else "",
        object=name, set=of_set, com_capped=bool(condition.get("com_shift")) and name == "candle",
        episode=episode, success=bool(won), settled_success=bool(won and rng.random() < 0.98),
        outcome="success" if won else _FAILURES[rng.choice(3, p=(0.5, 0.1, 0.4))],
        steps=int(40 + 300 * distance), object_path=distance, tool_path=distance + 0.4,
        keypoint_error=float("nan") if policy in _NO_KEYPOINT else float(error),
        start_x=start[0], start_y=start[1], goal_x=goal[0], goal_y=goal[1],
        final_x=final[0], final_y=final[1],
    )  # fmt: skip


def write_run(folder: Path, records: Sequence[Record]) -> Path:
    """Writes records as an evaluation does."""
    folder.mkdir(parents=True, exist_ok=True)
    write_records(records, folder / RECORDS_FILE)
    return folder


def gathered(folder: Path, records: Sequence[Record]) -> Episodes:
    """Takes records through a file to the episodes of a report."""
    return gather_episodes(read_runs([write_run(folder, records)]))
