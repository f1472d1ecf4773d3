"""Turns the finished shards of a job into a data set."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Any

import pyarrow.compute as pc

from keypush.dataset.features import FEATURES
from keypush.dataset.frames import frames_of_episode
from keypush.dataset.layout import INFO, JOB, SCENARIO
from keypush.dataset.shards import Shards
from keypush.dataset.writer import DatasetWriter
from keypush.errors import UserError

_PARTIAL = ".dataset.partial"


def assemble_dataset(shards: Path, out: Path) -> None:
    """Writes `out/data` and `out/meta` from the folder that a job has left.

    The same shards give the same bytes. A data set is there when `out/meta/info.json` is, and
    that is put in its place last; a run that was stopped leaves nothing that looks like one, and
    the next one begins anew.

    Args:
        shards: folder with job.yaml, scenario.yaml, rows/ and episodes/.
        out: folder for the data set; made if missing, may be `shards`.

    Raises:
        UserError: the job is not finished, a file is damaged, the policy period is no whole
            fraction of a second, or `out` holds another data set.
    """
    source = Shards.open(shards)
    fps = _frames_per_second(source)
    with new_dataset(out, shards / "job.yaml", shards / "scenario.yaml") as folder:
        blocks = source.blocks()
        first = next(blocks)  # a job has at least one
        with DatasetWriter(folder, FEATURES, first[0].schema, fps) as writer:
            for summaries, rows in chain([first], blocks):
                for summary in summaries.cast(writer.summaries).to_pylist():
                    mine = rows.filter(pc.equal(rows["episode"], summary["episode"]))
                    columns = frames_of_episode(mine, success=summary["success"])
                    writer.add(columns, task_of(summary["object"]), summary)


def task_of(name: str) -> str:
    """Returns what the robot is to do with an object, in words."""
    return f"push the {name.replace('_', ' ')} to the goal"


@contextmanager
def new_dataset(out: Path, job: Path, scenario: Path) -> Iterator[Path]:
    """Gives an empty folder, with the job's files in it, whose content then becomes `out`'s.

    Raises:
        UserError: `out` holds a data set of another job, or what is none.
    """
    _refuse_others(out, job, scenario)
    partial = out / _PARTIAL
    shutil.rmtree(partial, ignore_errors=True)
    (partial / "meta").mkdir(parents=True)
    try:
        shutil.copyfile(job, partial / JOB)
        shutil.copyfile(scenario, partial / SCENARIO)
        yield partial
        _put_in_place(partial, out)
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def _put_in_place(partial: Path, out: Path) -> None:
    """Replaces meta and data; between, there is no `meta/info.json`."""
    _flush_to_disk(partial)
    (out / INFO).unlink(missing_ok=True)
    (partial / INFO).rename(partial / "info.json")
    # meta first: it tells, should this be stopped here, that the folder may be written again.
    for name in ("meta", "data"):
        if (out / name).exists():
            (out / name).rename(partial / f"old_{name}")
        (partial / name).rename(out / name)
    (partial / "info.json").rename(out / INFO)


def _flush_to_disk(folder: Path) -> None:
    """So that after a loss of power what stands under its name is whole."""
    for path in [folder, *folder.rglob("*")]:
        handle = os.open(path, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _refuse_others(out: Path, job: Path, scenario: Path) -> None:
    if not ((out / "meta").exists() or (out / "data").exists()):
        return
    same = all(
        (out / there).is_file() and (out / there).read_bytes() == here.read_bytes()
        for there, here in ((JOB, job), (SCENARIO, scenario))
    )
    if not same:
        raise UserError(
            f"folder {out}: holds other data or meta; allowed: an empty folder, or one with the "
            "data set of the same job"
        )


def _frames_per_second(source: Shards) -> int:
    path, scenario = source.folder / "scenario.yaml", source.scenario()
    found: Any = None
    try:
        found = scenario["episode"]["policy_period"]
        return frames_per_second(float(found))
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    except (KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError) as error:
        told = "missing" if found is None else repr(found)
        raise UserError(
            f"{path}: episode.policy_period is {told}; allowed: the scenario that the job has "
            "written"
        ) from error


def frames_per_second(period: float) -> int:
    """Returns how many frames so many seconds apart a data set has in a second.

    Raises:
        UserError: it is no whole number.
    """
    fps = round(1 / period)
    if abs(fps * period - 1) > 1e-9:
        raise UserError(
            f"episode.policy_period is {period:g}; allowed in a data set: 1 s divided by a whole "
            "number, because it has frames per second"
        )
    return fps
