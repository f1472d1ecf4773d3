"""Copies of a data set that hold more than it stores."""

from pathlib import Path
from typing import Any

import pyarrow as pa

from keypush.dataset.arrays import to_array
from keypush.dataset.assemble import new_dataset
from keypush.dataset.clouds import episode_clouds
from keypush.dataset.features import CLOUD, cloud_feature
from keypush.dataset.layout import EPISODE_COLUMNS
from keypush.dataset.own_objects import refuse_changed_objects
from keypush.dataset.read import DataSet
from keypush.dataset.writer import DatasetWriter
from keypush.errors import UserError
from keypush.scenario import load_scenario


def export_clouds(dataset: DataSet, out: Path) -> None:
    """Writes the same data set with the field `observation.point_cloud`, about 6 kB per frame.

    Args:
        dataset: without that field.
        out: folder for the copy; made if missing.

    Raises:
        UserError: see `check_export`; or `out` holds another data set, an object is not there any
            more, or see `DataSet.each_episode`.
    """
    check_export(dataset, out)
    noise = load_scenario(dataset.scenario).noise
    features = (*dataset.features, cloud_feature(noise.cloud_points))
    own = pa.schema([f for f in dataset.episodes.schema if f.name not in EPISODE_COLUMNS.names])
    with (
        new_dataset(out, dataset.job, dataset.scenario) as folder,
        DatasetWriter(folder, features, own, dataset.fps) as writer,
    ):
        for told, frames in dataset.each_episode():
            columns = {name: to_array(frames[name]) for name in frames.column_names}
            columns[CLOUD] = episode_clouds(noise, told, columns["observation.object_pose"])
            writer.add(columns, _only_task(dataset, told), {name: told[name] for name in own.names})


def check_export(dataset: DataSet, out: Path) -> None:
    """Checks that a data set can be exported to a folder, before the folder is made.

    Raises:
        UserError: the data set has clouds already, an own object is another by now, or `out` is
            its own folder or lies in it, where the copy's files would pass for its own.
    """
    refuse_changed_objects(dataset)
    if any(feature.name == CLOUD for feature in dataset.features):
        raise UserError(f"{dataset.folder}: has {CLOUD} already; allowed: a data set without it")
    if out.resolve().is_relative_to(dataset.folder.resolve()):
        raise UserError(
            f"output folder {out}: is the data set's own, or inside it; allowed: another folder"
        )


def _only_task(dataset: DataSet, told: dict[str, Any]) -> str:
    if len(told["tasks"]) != 1:
        raise UserError(
            f"{dataset.folder}: tasks is {told['tasks']} in episode {told['episode_index']}; "
            "allowed: one"
        )
    return str(told["tasks"][0])
