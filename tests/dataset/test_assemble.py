"""From shards to a data set: what is written, in which bytes, and all or nothing."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from keypush.dataset import assemble as module
from keypush.dataset import writer as writer_module
from keypush.dataset.arrays import to_array
from keypush.dataset.assemble import assemble_dataset
from keypush.dataset.check import check_dataset
from keypush.dataset.features import FEATURES
from keypush.dataset.poses import hand_states
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.learning.hand import hand_state
from keypush.objects.point_cloud import pose_from_vector
from tests.dataset.real_shards import EPISODES, OBJECTS, results
from tests.learning.synthetic import STEPS, write_shards


def _bytes(folder: Path) -> dict[str, bytes]:
    files = [*(folder / "data").rglob("*"), *(folder / "meta").rglob("*")]
    return {str(p.relative_to(folder)): p.read_bytes() for p in files if p.is_file()}


def test_the_files_are_those_of_the_format(real: Path, real_shards: Path) -> None:
    assert set(_bytes(real)) == {
        "data/chunk-000/file-000.parquet",
        "meta/episodes/chunk-000/file-000.parquet",
        "meta/info.json",
        "meta/job.yaml",
        "meta/keypush.json",
        "meta/scenario.yaml",
        "meta/stats.json",
        "meta/tasks.parquet",
    }
    for name in ("job.yaml", "scenario.yaml"):
        assert (real / "meta" / name).read_bytes() == (real_shards / name).read_bytes()
    info = json.loads((real / "meta/info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["video_path"]) == ("v3.0", 10, None)
    assert list(info["features"]) == [feature.name for feature in FEATURES]
    assert info["splits"] == {"train": "0:4"}


def test_the_same_shards_give_the_same_bytes(real: Path, real_shards: Path, tmp_path: Path) -> None:
    assemble_dataset(real_shards, tmp_path)
    assert _bytes(tmp_path) == _bytes(real)
    assemble_dataset(real_shards, tmp_path)  # in place of itself
    assert _bytes(tmp_path) == _bytes(real)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["data", "meta"]


def test_frames_are_the_logged_rows_with_their_answers(real: Path) -> None:
    dataset = open_dataset(real)
    for k, (name, i) in enumerate((n, i) for n in OBJECTS for i in range(EPISODES)):
        rows, summary = results(name)[i].rows, results(name)[i].summary
        told, frames = dataset.episode(k)
        assert {key: told[key] for key in ("object", "episode", "size_ratio", "outcome")} == {
            key: summary[key] for key in ("object", "episode", "size_ratio", "outcome")
        }
        assert told["tasks"] == [f"push the {name.replace('_', ' ')} to the goal"]
        assert told["length"] == len(rows["time"])
        column = {field: to_array(frames[field]) for field in frames.column_names}
        np.testing.assert_array_equal(column["observation.object_pose"], rows["object_pose"])
        state = np.hstack([rows["q"], rows["v"]]).astype(np.float32)
        np.testing.assert_array_equal(column["observation.state"], state)
        # What the planner answers to a row stands in the next one.
        np.testing.assert_array_equal(column["action"][:-1], rows["action"][1:].astype(np.float32))
        np.testing.assert_array_equal(column["action"][-1], np.zeros(6))
        target = rows["target"][1:].astype(np.float32)
        np.testing.assert_array_equal(column["contact.analytic"][:-1], target)
        assert np.isnan(column["contact.analytic"][-1]).all()
        np.testing.assert_array_equal(column["stage"], rows["stage"])
        np.testing.assert_allclose(column["timestamp"], 0.1 * np.arange(len(frames)), atol=1e-6)
        assert column["next.done"].tolist() == [False] * (len(frames) - 1) + [True]


def test_every_summary_column_is_kept(real: Path, real_shards: Path) -> None:
    stored = open_dataset(real).episodes
    shard = pq.read_table(next((real_shards / "episodes").glob("plate-000000*")))
    assert set(shard.column_names) <= set(stored.column_names)
    for name in shard.column_names:
        assert stored[name][0].as_py() == shard[name][0].as_py()


def test_hand_states_are_those_of_the_network() -> None:
    rng = np.random.default_rng(0)
    poses = np.hstack([rng.normal(size=(5, 4)), rng.normal(size=(5, 3))])
    poses[:, :4] /= np.linalg.norm(poses[:, :4], axis=1, keepdims=True)
    expected = [hand_state(pose_from_vector(pose).GetAsMatrix4()) for pose in poses]
    np.testing.assert_allclose(hand_states(poses), expected, atol=1e-12)


def test_success_is_told_on_the_last_frame(synthetic: Path) -> None:
    dataset = open_dataset(synthetic)
    frames = dataset.read(["next.success"])
    expected = np.zeros((9, STEPS), dtype=bool)
    expected[dataset.episodes["success"].to_numpy(zero_copy_only=False), -1] = True
    np.testing.assert_array_equal(to_array(frames["next.success"]), expected.ravel())
    assert expected.sum() == 6


def test_many_groups_and_files_hold_the_same_frames(
    synthetic: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(writer_module, "_GROUP_BYTES", 1)
    monkeypatch.setattr(writer_module, "MEGABYTES_PER_FILE", 0.004)
    monkeypatch.setattr("keypush.dataset.layout.FILES_PER_CHUNK", 2)
    assemble_dataset(synthetic / "shards", tmp_path)
    names = [feature.name for feature in FEATURES]
    cut, whole = open_dataset(tmp_path), open_dataset(synthetic)
    assert len(cut.files) > 3
    assert (tmp_path / "data/chunk-001/file-001.parquet").exists()
    for name in names:
        found, expected = (to_array(d.read([name])[name]) for d in (cut, whole))
        np.testing.assert_array_equal(found, expected)
    assert [told["episode"] for told, _ in cut.each_episode()] == [0, 1, 2] * 3
    for number in range(9):
        assert cut.episode(number)[0]["object"] == whole.episode(number)[0]["object"]
        assert len(cut.episode(number)[1]) == STEPS
    assert all(check.ok for check in check_dataset(cut).values())


def test_a_run_that_is_stopped_leaves_no_data_set(
    synthetic: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shards = synthetic / "shards"

    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "frames_of_episode", stopped)
    with pytest.raises(KeyboardInterrupt):
        assemble_dataset(shards, tmp_path)
    assert list(tmp_path.iterdir()) == []
    monkeypatch.undo()
    # Stopped while the folders are put in their place.
    rename = Path.rename

    def rename_no_data(path: Path, target: Path) -> Path:
        if target == tmp_path / "data":
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", rename_no_data)
    with pytest.raises(KeyboardInterrupt):
        assemble_dataset(shards, tmp_path)
    monkeypatch.undo()
    with pytest.raises(UserError, match=r"meta/info\.json"):
        open_dataset(tmp_path)
    assemble_dataset(shards, tmp_path)
    assert _bytes(tmp_path) == _bytes(synthetic)


def test_other_data_are_not_overwritten(synthetic: Path, tmp_path: Path) -> None:
    write_shards(tmp_path / "shards", [("block", 1.0)], episodes=1)
    assemble_dataset(tmp_path / "shards", tmp_path)
    before = _bytes(tmp_path)
    with pytest.raises(UserError, match="holds other data or meta; allowed: an empty folder"):
        assemble_dataset(synthetic / "shards", tmp_path)
    assert _bytes(tmp_path) == before
    (tmp_path / "mine" / "data").mkdir(parents=True)
    with pytest.raises(UserError, match="holds other data or meta"):
        assemble_dataset(synthetic / "shards", tmp_path / "mine")


MISSING = "can-000000.parquet"


def _change_period(shards: Path) -> None:
    path = shards / "scenario.yaml"
    text = path.read_text()
    assert "policy_period: 0.1" in text
    path.write_text(text.replace("policy_period: 0.1", "policy_period: 0.03"))


def _shorten(shards: Path) -> None:
    path = shards / "rows" / MISSING
    table = pq.read_table(path)
    pq.write_table(table.filter(pa.compute.less(table["episode"], 2)), path)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda s: (s / "episodes" / MISSING).unlink(), "0 of 3 episodes of can are there"),
        (lambda s: (s / "rows" / MISSING).unlink(), r"rows/can-000000\.parquet: cannot be read"),
        (lambda s: (s / "rows" / MISSING).write_bytes(b"PAR1"), "can-000000.*cannot be read"),
        (lambda s: (s / "job.yaml").unlink(), r"job\.yaml: cannot be read"),
        (lambda s: (s / "job.yaml").write_text("[]"), r"job\.yaml: holds no mapping"),
        (
            lambda s: (s / "job.yaml").write_text("{}"),
            r"job\.yaml: objects is None and episodes None",
        ),
        (lambda s: (s / "scenario.yaml").write_text("{}"), "policy_period is missing"),
        (_change_period, "policy_period is 0.03; allowed in a data set"),
        (_shorten, "rows/ and episodes/ disagree"),
    ],
)
def test_shards_that_are_not_finished_are_refused(
    synthetic: Path,
    tmp_path: Path,
    damage: Callable[[Path], object],
    message: str,
) -> None:
    shards = Path(shutil.copytree(synthetic / "shards", tmp_path / "shards"))
    damage(shards)
    with pytest.raises(UserError, match=message) as caught:
        assemble_dataset(shards, tmp_path / "out")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists() or list((tmp_path / "out").iterdir()) == []


_ON_A_FULL_DISK = """
import resource, sys
from pathlib import Path
from keypush.dataset import writer
from keypush.dataset.assemble import assemble_dataset
writer._GROUP_BYTES = 1  # so that a file has several row groups
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[3]),) * 2)
try:
    assemble_dataset(Path(sys.argv[1]), Path(sys.argv[2]))
except OSError as error:
    print(error.strerror)
"""


@pytest.mark.parametrize("room", [3000, 30_000])
def test_a_full_disk_leaves_one_error_and_no_data_set(
    room: int, real_shards: Path, tmp_path: Path
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _ON_A_FULL_DISK, real_shards, tmp_path, str(room)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.endswith("File too large\n")
    assert done.stderr == ""
    assert not list(tmp_path.iterdir())
