"""Damaged and foreign files in a job's folder are named, and nothing else is touched."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from keypush.errors import UserError
from keypush.rollout.folder_lock import hold_folder
from keypush.rollout.job import Job
from keypush.rollout.parallel import run_job
from keypush.rollout.store import EpisodeStore
from tests.rollout.short_scenarios import bytes_of, short_scenario

Damage = Callable[[Path], None]


def _job() -> Job:
    return Job(scenario=short_scenario(), objects=("plate", "can"), episodes=2)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("finished")
    run_job(_job(), folder, workers=1)
    return folder


@pytest.fixture
def folder(finished: Path, tmp_path: Path) -> Path:
    shutil.copytree(finished, tmp_path, dirs_exist_ok=True)
    return tmp_path


def _cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-20])


def _flip(*names: str) -> Damage:
    """Damages the one of these columns that a file has."""

    def flip(path: Path) -> None:
        group = pq.ParquetFile(path).metadata.row_group(0)
        columns = [group.column(i) for i in range(group.num_columns)]
        (found,) = (column for column in columns if column.path_in_schema in names)
        content = bytearray(path.read_bytes())
        start = found.dictionary_page_offset or found.data_page_offset
        content[start + found.total_compressed_size - 1] ^= 1
        path.write_bytes(content)

    return flip


def _empty(path: Path) -> None:
    path.write_bytes(b"")


def _without(column: str) -> Damage:
    return lambda path: pq.write_table(pq.read_table(path).drop_columns([column]), path)


def _with_another_column(path: Path) -> None:
    table = pq.read_table(path)
    pq.write_table(table.append_column("extra", pa.array([0] * len(table))), path)


def _of_another_object(path: Path) -> None:
    shutil.copyfile(path.with_name("plate-000000.parquet"), path)


def _without_last_row(path: Path) -> None:
    table = pq.read_table(path)
    pq.write_table(table.slice(0, len(table) - 3), path)


def _with_a_row_twice(path: Path) -> None:
    table = pq.read_table(path)
    pq.write_table(pa.concat_tables([table.slice(0, 1), table]), path)


def _of_another_seed(path: Path) -> None:
    table = pq.read_table(path)
    index = table.column_names.index("seed")
    pq.write_table(table.set_column(index, "seed", pa.array([9] * len(table))), path)


BOTH: list[tuple[Damage, str]] = [
    (_cut, "cannot be read"),
    (_empty, "cannot be read"),
    (_flip("episode"), "cannot be read"),
    (_flip("v.list.element", "outcome"), "cannot be read"),
    (_without("episode"), "lacks the columns episode"),
    (_with_another_column, "extra"),
    (_of_another_object, "holds other"),
    (_of_another_seed, "holds other"),
    (_without_last_row, "holds other"),
    (_with_a_row_twice, "holds other"),
]


@pytest.mark.parametrize("kind", ["rows", "episodes"])
@pytest.mark.parametrize(("damage", "words"), BOTH)
def test_a_damaged_file_is_named(damage: Damage, words: str, kind: str, folder: Path) -> None:
    path = folder / kind / "can-000000.parquet"
    damage(path)
    before = bytes_of(folder)
    with pytest.raises(UserError, match=words) as caught:
        EpisodeStore(folder).open(_job())
    assert "can-000000.parquet" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert bytes_of(folder) == before


@pytest.mark.parametrize("kind", ["rows", "episodes"])
def test_the_block_of_a_file_that_was_removed_runs_again(
    kind: str, folder: Path, finished: Path
) -> None:
    (folder / kind / "can-000000.parquet").unlink()
    run_job(_job(), folder, workers=1)
    assert bytes_of(folder) == bytes_of(finished)


def test_a_file_of_another_job_is_named(folder: Path) -> None:
    shutil.copyfile(folder / "rows" / "can-000000.parquet", folder / "rows" / "mug-000000.parquet")
    with pytest.raises(UserError, match=r"rows/mug-000000\.parquet: is no part of this job"):
        EpisodeStore(folder).open(_job())


def test_new_blocks_do_not_mix_with_old_columns(folder: Path) -> None:
    for path in (folder / "rows").glob("can-*"):
        path.unlink()
    _without("v")(folder / "rows" / "plate-000000.parquet")
    with pytest.raises(UserError, match=r"can-000000\.parquet: its columns are not .*\(v\)"):
        run_job(_job(), folder, workers=1)


@pytest.mark.parametrize("name", ["job.yaml", "scenario.yaml"])
def test_a_lost_description_is_not_made_up(name: str, folder: Path) -> None:
    (folder / name).unlink()
    with pytest.raises(UserError, match=f"{name}: cannot be read: .*No such file"):
        EpisodeStore(folder).open(_job())
    assert not (folder / name).exists()


@pytest.mark.parametrize("text", ["objects: [", "keypush: 2000-13-01", 1000 * "["])
@pytest.mark.parametrize("name", ["job.yaml", "scenario.yaml"])
def test_a_broken_description_is_named(name: str, text: str, folder: Path) -> None:
    (folder / name).write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match=f"{name}: cannot be read"):
        EpisodeStore(folder).open(_job())


def test_a_second_run_in_the_folder_is_refused(tmp_path: Path) -> None:
    with hold_folder(tmp_path), pytest.raises(UserError, match="another run is at work"):
        run_job(_job(), tmp_path, workers=1)
    with hold_folder(tmp_path):
        pass
