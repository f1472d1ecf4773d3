"""Shards of short real episodes, as a job leaves them."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.rollout.parquet import table_from_rows
from keypush.scenario import Scenario, dump_scenario, parse_scenario

OBJECTS = ("plate", "mug_2")
EPISODES = 2


@cache
def scenario() -> Scenario:
    """An expert that is stopped after a second and a half, with an object of varied size."""
    return parse_scenario(
        "{policy: expert, seed: 5, episode: {max_steps: 15}, noise: {cloud_points: 64},"
        " variation: {size: [0.9, 1.1]}}"
    )


@cache
def results(name: str) -> list[EpisodeResult]:
    """The episodes of one object."""
    mine = replace(scenario(), object=replace(scenario().object, name=name))
    runner = EpisodeRunner(mine)
    return [runner.run(episode) for episode in range(EPISODES)]


def write_real_shards(folder: Path) -> Path:
    """Writes them, one block of one episode each."""
    for kind in ("rows", "episodes"):
        (folder / kind).mkdir(parents=True)
    for name in OBJECTS:
        for i, result in enumerate(results(name)):
            file = f"{name}-{i:06d}.parquet"
            pq.write_table(table_from_rows([result.rows]), folder / "rows" / file)
            pq.write_table(pa.Table.from_pylist([result.summary]), folder / "episodes" / file)
    job = {"objects": list(OBJECTS), "episodes": EPISODES, "keypush": "0"}
    (folder / "job.yaml").write_text(yaml.safe_dump(job, sort_keys=False))
    (folder / "scenario.yaml").write_text(dump_scenario(scenario()))
    return folder
