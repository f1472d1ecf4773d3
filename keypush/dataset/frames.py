"""From the rows that an episode's log left to the frames of the data set."""

from collections.abc import Mapping

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from keypush.dataset.arrays import to_array
from keypush.dataset.keypoint import keypoints
from keypush.dataset.poses import hand_states

Columns = Mapping[str, NDArray[np.generic]]


def frames_of_episode(rows: pa.Table, *, success: bool) -> Columns:
    """Returns the fields of one episode's frames, all but those that number them.

    A row is logged before the planner acts on it, so that the answer to it, action and target,
    stands in the next row. A frame holds what was seen and the answer to it.

    Args:
        rows: of one episode, by step; see `keypush.systems.episode_logger`.
        success: whether the episode succeeded.

    Returns:
        Arrays (n, ...) in the order of `features.FEATURES`.
    """
    count = rows.num_rows
    row = {name: to_array(rows[name]) for name in rows.column_names if name != "object"}
    last = np.arange(count) == count - 1
    p_WK = keypoints(
        row["stage"], row["object_pose"], row["contact_point"], np.zeros(count, dtype=np.int64)
    )
    return {
        "observation.state": np.hstack([row["q"], row["v"]]),
        "observation.hand_state": hand_states(row["tool_pose"]),
        "observation.tool_pose": row["tool_pose"],
        "observation.object_pose": row["object_pose"],
        "observation.com": row["com"],
        "observation.goal": row["goal"],
        "action": _answers(row["action"], 0.0),
        "stage": row["stage"],
        "contact.measured": row["contact_point"],
        "contact.force": row["contact_force"],
        "contact.analytic": _answers(row["target"], np.nan),
        "keypoint": p_WK,
        "next.done": last,
        "next.success": last & success,
        "timestamp": row["time"],
    }


def _answers(column: NDArray[np.float64], missing: float) -> NDArray[np.float64]:
    """Moves each row's answer from the next row to its own; the last row has none."""
    return np.concatenate([column[1:], np.full_like(column[:1], missing)])
