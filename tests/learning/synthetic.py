"""Data sets without simulation: objects at random poses, with the expert's own contact as label."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from keypush.objects.library import make_object
from keypush.planning.contact import analytic_contact

STEPS = 5
PUSH = 4


def write_data(
    data_dir: Path, objects: list[tuple[str, float]], episodes: int, seed: int = 0
) -> Path:
    """Writes `episodes` episodes per (name, size ratio), each of `STEPS` rows of pushing."""
    rng = np.random.default_rng(seed)
    rows, summaries = [], []
    for name, ratio in objects:
        model = make_object(name, ratio)
        points = model.surface_points(4000, rng)
        for episode in range(episodes):
            key = {"object": name, "size_ratio": ratio, "seed": seed, "episode": episode}
            summaries.append({**key, "success": True, "outcome": "success", "steps": STEPS})
            start, goal = rng.uniform([-0.16, -0.2], [0.16, 0.2], (2, 2))
            target = [np.nan] * 3
            yaw = rng.uniform(-np.pi, np.pi)
            for step in range(STEPS):
                share = step / STEPS
                position = np.array([*(start + share * (goal - start)), model.rest_height])
                row = _row(points, model.p_OoOcm_O, position, yaw + 0.1 * step, goal, rng)
                # A row has the target that was held when it was logged: see `aimed_contact`.
                row["target"], target = target, row["target"]
                rows.append({**key, "step": step, "stage": PUSH, **row})
    for folder, content in (("rows", rows), ("episodes", summaries)):
        (data_dir / folder).mkdir(parents=True, exist_ok=True)
        pq.write_table(pa.Table.from_pylist(content), data_dir / folder / "part-0.parquet")
    return data_dir


def _row(
    points: NDArray[np.float64],
    p_OcmO: NDArray[np.float64],
    position: NDArray[np.float64],
    yaw: float,
    goal: NDArray[np.float64],
    rng: np.random.Generator,
) -> dict[str, list[float]]:
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
        "object_pose": [np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2), *position],
        "com": com.tolist(),
        "goal": goal.tolist(),
        "tool_pose": [0.0, 1.0, 0.0, 0.0, *tool],
        "contact_point": contact.tolist(),
        "target": target.tolist(),
    }
