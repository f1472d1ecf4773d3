"""Rows of expert episodes, read from a data set."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from keypush.dataset.arrays import to_array
from keypush.dataset.bad_frame import find_bad_frame
from keypush.dataset.features import FEATURES
from keypush.dataset.own_objects import refuse_changed_objects
from keypush.dataset.read import DataSet, open_dataset
from keypush.errors import UserError

COLUMNS = {
    "stage": "stage",
    "object_pose": "observation.object_pose",
    "com": "observation.com",
    "goal": "observation.goal",
    "tool_pose": "observation.tool_pose",
    "contact_point": "contact.measured",
    "target": "contact.analytic",
    "action": "action",
}
"""Attributes of `Rows` and the fields that they come from."""
_ONLY_CHECKED = ("keypoint",)
"""What `labels` makes anew from the other fields."""


@dataclass(frozen=True)
class Rows:
    """n rows, ordered by episode and step; poses are (qw, qx, qy, qz, x, y, z).

    Attributes:
        objects: the (catalogue name, size ratio) pairs that occur.
        seeds: the scenario seeds that occur.
        object_index: entry of `objects`, (n,).
        episode: number of the episode in the data set, (n,).
        stage: of the expert, (n,).
        object_pose: X_WO, (n, 7).
        com: p_WOcm, (n, 3).
        goal: xy in W, (n, 2).
        tool_pose: X_WE, (n, 7).
        contact_point: measured contact of tool and object in W, NaN without, (n, 3).
        target: the p_target in W that the expert chose on seeing the row, NaN in last rows, (n, 3).
        action: the tool action that the expert chose on seeing the row, m and rad, (n, 6).
    """

    objects: Sequence[tuple[str, float]]
    seeds: Sequence[int]
    object_index: NDArray[np.int64]
    episode: NDArray[np.int64]
    stage: NDArray[np.int64]
    object_pose: NDArray[np.float64]
    com: NDArray[np.float64]
    goal: NDArray[np.float64]
    tool_pose: NDArray[np.float64]
    contact_point: NDArray[np.float64]
    target: NDArray[np.float64]
    action: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.episode)


def read_rows(data_dir: Path, *, keep_failures: bool = False) -> Rows:
    """Reads all rows of a data set.

    Args:
        data_dir: folder of a data set.
        keep_failures: whether to read episodes that failed too.

    Raises:
        UserError: see `open_dataset`; or an own object is another by now, no episode is left, or a
            number is not finite where one is needed.
    """
    dataset = open_dataset(data_dir)
    refuse_changed_objects(dataset)
    episodes = dataset.episodes
    kept = episodes if keep_failures else episodes.filter(episodes["success"])
    if not len(kept):
        raise UserError(
            f"data {data_dir}: found no successful episode of {len(episodes)}; "
            "allowed: at least one"
        )
    pairs = list(zip(kept["object"].to_pylist(), kept["size_ratio"].to_pylist(), strict=True))
    objects = sorted(set(pairs))
    position = {pair: i for i, pair in enumerate(objects)}
    columns = _read_columns(dataset, kept["episode_index"])
    numbers = to_array(kept["episode_index"])
    of_episode = np.array([position[pair] for pair in pairs])
    episode = columns.pop("episode")
    return Rows(
        objects=objects,
        seeds=sorted(set(kept["seed"].to_pylist())),
        object_index=of_episode[np.searchsorted(numbers, episode)],
        episode=episode,
        **columns,
    )


def _read_columns(dataset: DataSet, numbers: pa.ChunkedArray) -> dict[str, NDArray[Any]]:
    """Reads the rows of some episodes, a part at a time, so that the others take no memory."""
    wanted = {"episode": "episode_index", **COLUMNS}
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name in wanted}
    for table in dataset.batches([*wanted.values(), *_ONLY_CHECKED]):
        mine = table.filter(pc.is_in(table["episode_index"], value_set=numbers))
        if not len(mine):
            continue
        _check_numbers(dataset.folder, mine)
        for name, field in wanted.items():
            values = to_array(mine[field])
            parts[name].append(values.astype(np.float64) if values.dtype.kind == "f" else values)
    return {name: np.concatenate(part) for name, part in parts.items()}


def _check_numbers(folder: Path, table: pa.Table) -> None:
    bad = find_bad_frame(table, FEATURES)
    if bad is not None:
        raise UserError(
            f"data {folder}: {bad.found} in episode {table['episode_index'][bad.row]}; "
            f"allowed: {bad.allowed}"
        )
