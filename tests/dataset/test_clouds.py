"""Clouds are rebuilt from frames, bit for bit as the sensor gave them."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, EventStatus

from keypush.dataset.arrays import to_array
from keypush.dataset.check import check_dataset
from keypush.dataset.clouds import episode_clouds
from keypush.dataset.export import export_clouds
from keypush.dataset.features import CLOUD, FEATURES
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.rollout.episode import EpisodeRunner
from tests.dataset.edit import EPISODES, edit_table, set_values
from tests.dataset.real_shards import OBJECTS, scenario


class WatchedRunner(EpisodeRunner):
    """Keeps what the sensor's port gives at every policy step."""

    def watch(self, episode: int) -> list[NDArray[np.float64]]:
        self.reset(episode)
        port = self.push.station.diagram.GetOutputPort("point_cloud")
        seen: dict[int, NDArray[np.float64]] = {}

        def look(root: Context) -> EventStatus:
            step = round(root.get_time() / 0.1)
            if abs(root.get_time() - 0.1 * step) < 1e-9:
                mine = self.push.station.diagram.GetMyContextFromRoot(root)
                seen[step] = np.array(port.Eval(mine)).reshape(-1, 3)
            return EventStatus.DidNothing()

        simulator: Simulator = self._simulator
        simulator.set_monitor(look)
        simulator.Initialize()
        simulator.AdvanceTo(2.0)
        return [seen[step] for step in sorted(seen)]


@pytest.mark.parametrize("number", [0, 3])
def test_they_are_those_of_the_sensors_port(real: Path, number: int) -> None:
    told, frames = open_dataset(real).episode(number)
    name = OBJECTS[number // 2]
    mine = replace(scenario(), object=replace(scenario().object, name=name))
    measured = WatchedRunner(mine).watch(number % 2)
    rebuilt = episode_clouds(scenario().noise, told, to_array(frames["observation.object_pose"]))
    assert len(measured) == len(rebuilt) == 16
    assert rebuilt.tobytes() == np.array(measured).tobytes()
    assert np.abs(rebuilt[1] - rebuilt[0]).max() > 1e-3


def test_the_exported_copy_has_them(real: Path, tmp_path: Path) -> None:
    dataset = open_dataset(real)
    export_clouds(dataset, tmp_path / "out")
    copy = open_dataset(tmp_path / "out")
    assert [f.name for f in copy.features] == [*(f.name for f in FEATURES), CLOUD]
    for number in range(4):
        told, frames = copy.episode(number)
        before, plain = dataset.episode(number)
        assert {**before, "tasks": None} == {**told, "tasks": None}
        clouds = episode_clouds(scenario().noise, told, to_array(frames["observation.object_pose"]))
        np.testing.assert_array_equal(to_array(frames[CLOUD]), clouds.astype(np.float32))
        for name in plain.column_names:
            np.testing.assert_array_equal(to_array(frames[name]), to_array(plain[name]))
    checks = check_dataset(copy)
    assert all(check.ok for check in checks.values())
    assert checks["clouds"].found != "0"


def test_an_episode_without_a_task_is_not_exported(real: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(real / "meta", tmp_path / "copy" / "meta").parent
    shutil.copytree(real / "data", copy / "data")
    edit_table(copy / EPISODES, lambda t: set_values(t, "tasks", lambda v: v.__setitem__(1, [])))
    with pytest.raises(UserError, match=r"tasks is \[\] in episode 1; allowed: one"):
        export_clouds(open_dataset(copy), tmp_path / "out")


def test_exports_that_make_no_sense_are_refused(real: Path, tmp_path: Path) -> None:
    dataset = open_dataset(real)
    for inside in (real, real / "data", real / "data" / "copy"):
        with pytest.raises(
            UserError, match="is the data set's own, or inside it; allowed: another"
        ):
            export_clouds(dataset, inside)
    export_clouds(dataset, tmp_path / "out")
    with pytest.raises(UserError, match=r"has observation\.point_cloud already"):
        export_clouds(open_dataset(tmp_path / "out"), tmp_path / "twice")
