"""Data sets without simulation: objects at random poses, with the expert's own contact as label."""

from collections import Counter
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import yaml
from numpy.typing import NDArray

from keypush.dataset.assemble import assemble_dataset
from keypush.objects.library import make_object
from keypush.objects.model import ObjectModel
from keypush.planning.contact import analytic_contact
from keypush.rollout.parquet import table_from_rows
from keypush.scenario import Scenario, dump_scenario

STEPS = 5
PUSH = 4
PERIOD = 0.1
OTHERS = {"q": 7, "v": 7, "contact_force": 3}
"""Columns of which nothing is learnt."""

Rows = dict[str, NDArray[np.generic]]


def write_data(
    data_dir: Path,
    objects: list[tuple[str, float]],
    episodes: int,
    seed: int = 0,
    failures: int = 0,
) -> Path:
    """Writes a data set of `episodes` episodes per (name, size ratio), `STEPS` frames each.

    Every name has the same number of size ratios; the first `failures` episodes of each name fail.
    """
    shards = write_shards(data_dir / "shards", objects, episodes, seed, failures)
    assemble_dataset(shards, data_dir)
    return data_dir


def write_shards(
    folder: Path,
    objects: list[tuple[str, float]],
    episodes: int,
    seed: int = 0,
    failures: int = 0,
) -> Path:
    """Writes what a job of these episodes leaves; see `write_data`."""
    rng = np.random.default_rng(seed)
    done: Counter[str] = Counter()
    for kind in ("rows", "episodes"):
        (folder / kind).mkdir(parents=True)
    for name, ratio in objects:
        model = make_object(name, ratio)
        points = model.surface_points(4000, rng)
        numbers = range(done[name], done[name] + episodes)
        rows = [_episode(model, points, seed, number, rng) for number in numbers]
        summaries = [_summary(name, ratio, seed, i, success=i >= failures) for i in numbers]
        file = f"{name}-{done[name]:06d}.parquet"
        pq.write_table(table_from_rows(rows), folder / "rows" / file)
        pq.write_table(pa.Table.from_pylist(summaries), folder / "episodes" / file)
        done[name] += episodes
    job = {"objects": list(done), "episodes": max(done.values())}
    (folder / "job.yaml").write_text(yaml.safe_dump(job, sort_keys=False))
    (folder / "scenario.yaml").write_text(dump_scenario(Scenario(seed=seed, policy="expert")))
    return folder


def _summary(
    name: str, ratio: float, seed: int, episode: int, *, success: bool
) -> dict[str, object]:
    return {
        "object": name, "size_ratio": ratio, "seed": seed, "episode": episode, "success": success,
        "settled_success": success, "outcome": "success" if success else "fell", "steps": STEPS,
        "com_offset": [0.0, 0.0],
    }  # fmt: skip


def _episode(
    model: ObjectModel,
    points: NDArray[np.float64],
    seed: int,
    episode: int,
    rng: np.random.Generator,
) -> Rows:
    others = np.random.default_rng([seed, episode])
    start, goal = rng.uniform([-0.16, -0.2], [0.16, 0.2], (2, 2))
    yaw = rng.uniform(-np.pi, np.pi)
    frames = []
    for step in range(STEPS):
        share = step / STEPS
        position = np.array([*(start + share * (goal - start)), model.rest_height])
        frames.append(_row(points, model.p_OoOcm_O, position, yaw + 0.1 * step, goal, rng))
    rows = {name: np.array([frame[name] for frame in frames]) for name in frames[0]}
    # A row has the target that was held when it was logged: the answer stands in the next row.
    rows["target"] = np.vstack([np.zeros((1, 3)), rows["target"][:-1]])
    return {
        "object": np.full(STEPS, model.name),
        "size_ratio": np.full(STEPS, model.size_ratio),
        "seed": np.full(STEPS, seed, dtype=np.int64),
        "episode": np.full(STEPS, episode, dtype=np.int32),
        "step": np.arange(STEPS, dtype=np.int32),
        "time": PERIOD * np.arange(STEPS),
        "stage": np.full(STEPS, PUSH, dtype=np.int8),
        "action": np.full((STEPS, 6), 0.01 * np.arange(STEPS)[:, None]),
        **{name: others.uniform(-1, 1, (STEPS, size)) for name, size in OTHERS.items()},
        **rows,
    }


def _row(
    points: NDArray[np.float64],
    p_OcmO: NDArray[np.float64],
    position: NDArray[np.float64],
    yaw: float,
    goal: NDArray[np.float64],
    rng: np.random.Generator,
) -> dict[str, NDArray[np.float64]]:
    yaw = (yaw + np.pi) % (2 * np.pi) - np.pi  # so that the quaternion has qw >= 0
    c, s = np.cos(yaw), np.sin(yaw)
    R_WO = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    com = R_WO @ p_OcmO + position
    offset = np.array([*(goal - com[:2]), 0.0])
    d_W = offset / np.linalg.norm(offset)
    target = analytic_contact(points @ R_WO.T + position, com, d_W, 0.02, (0.012, 0.04))
    contact = target + rng.normal(0, 0.002, 3)
    # The tool looks straight down, some way behind the contact.
    tool = target - 0.03 * d_W + [0.0, 0.0, rng.uniform(0.0, 0.1)]
    return {
        "object_pose": np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2), *position]),
        "com": com,
        "goal": goal,
        "tool_pose": np.array([0.0, 1.0, 0.0, 0.0, *tool]),
        "contact_point": contact,
        "target": target,
    }
