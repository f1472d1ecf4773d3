"""Rows of expert episodes, read from the Parquet files that `keypush collect` writes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from keypush.errors import UserError

KEY_TYPES = {
    "object": pa.string(),
    "size_ratio": pa.float64(),
    "seed": pa.int64(),
    "episode": pa.int64(),
}
KEY = list(KEY_TYPES)
WIDTHS = {
    "object_pose": 7,
    "com": 3,
    "goal": 2,
    "tool_pose": 7,
    "contact_point": 3,
    "target": 3,
}


@dataclass(frozen=True)
class Rows:
    """n rows, ordered by episode and step; poses are (qw, qx, qy, qz, x, y, z).

    Attributes:
        objects: the (catalogue name, size ratio) pairs that occur.
        seeds: the scenario seeds that occur.
        object_index: entry of `objects`, (n,).
        episode: running number of the episode, (n,).
        stage: of the expert, (n,).
        object_pose: X_WO, (n, 7).
        com: p_WOcm, (n, 3).
        goal: xy in W, (n, 2).
        tool_pose: X_WE, (n, 7).
        contact_point: measured contact of tool and object in W, NaN without, (n, 3).
        target: the expert's p_target in W, (n, 3).
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

    def __len__(self) -> int:
        return len(self.episode)


def read_rows(data_dir: Path, *, keep_failures: bool = False) -> Rows:
    """Reads all rows of a data set.

    Args:
        data_dir: folder with `rows/*.parquet` and `episodes/*.parquet`.
        keep_failures: whether to read episodes that failed too.

    Raises:
        UserError: there are no files, a column is missing, or no episode is left.
    """
    table = _read(data_dir / "rows", [*KEY, "step", "stage", *WIDTHS])
    if not keep_failures:
        episodes = _read(data_dir / "episodes", [*KEY, "success"])
        succeeded = episodes.filter(episodes["success"]).select(KEY)
        # Arrow cannot join tables with columns of lists, so row numbers are joined.
        numbered = table.select(KEY).append_column("row", pa.array(np.arange(len(table))))
        kept = numbered.join(succeeded, keys=KEY, join_type="left semi")["row"]
        table = table.take(kept)
    if table.num_rows == 0:
        kind = "rows" if keep_failures else "rows of successful episodes"
        raise UserError(f"data {data_dir}: found no {kind}; allowed: at least one episode")
    table = table.sort_by([(name, "ascending") for name in [*KEY, "step"]])
    return _to_rows(table)


def _read(folder: Path, columns: list[str]) -> pa.Table:
    files = sorted(folder.glob("*.parquet"))
    if not files:
        raise UserError(
            f"data folder {folder}: found no *.parquet; allowed: a folder that "
            "`keypush collect` wrote"
        )
    tables = []
    for file in files:
        try:
            missing = set(columns) - set(pq.read_schema(file).names)
            if missing:
                raise UserError(f"{file}: columns missing: {', '.join(sorted(missing))}")
            table = pq.read_table(file, columns=columns)
            # Rows and episodes may store their keys with different widths.
            types = [pa.field(f.name, KEY_TYPES.get(f.name, f.type)) for f in table.schema]
            tables.append(table.cast(pa.schema(types)))
        except (OSError, pa.ArrowException) as error:
            raise UserError(f"{file}: cannot be read: {' '.join(str(error).split())}") from error
    return pa.concat_tables(tables, promote_options="permissive")


def _to_rows(table: pa.Table) -> Rows:
    names = np.asarray(table["object"].to_pylist())
    ratios = table["size_ratio"].to_numpy()
    key = [names, ratios, table["seed"].to_numpy(), table["episode"].to_numpy()]
    changed = np.zeros(len(names), dtype=bool)
    for column in key:
        changed[1:] |= column[1:] != column[:-1]
    pairs = list(zip(names.tolist(), ratios.tolist(), strict=True))
    objects = sorted(set(pairs))
    position = {pair: i for i, pair in enumerate(objects)}
    return Rows(
        objects=objects,
        seeds=np.unique(key[2]).tolist(),
        object_index=np.array([position[pair] for pair in pairs]),
        episode=changed.cumsum(),
        stage=table["stage"].to_numpy().astype(np.int64),
        **{name: _matrix(table[name], name, width) for name, width in WIDTHS.items()},
    )


def _matrix(column: pa.ChunkedArray, name: str, width: int) -> Any:
    """A column of lists of `width` numbers as an array (n, width)."""
    flat = column.combine_chunks().flatten().to_numpy(zero_copy_only=False)
    if len(flat) != width * len(column):
        raise UserError(f"column {name}: allowed: {width} numbers in every row")
    return flat.reshape(-1, width).astype(np.float64)
