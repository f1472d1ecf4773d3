"""A part of a reproduction: one policy under one condition, in a folder of its own."""

import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from keypush.errors import UserError
from keypush.evaluation.conditions import condition_name
from keypush.evaluation.evaluate import collect_records, run_conditions
from keypush.evaluation.records import RECORDS_FILE, read_records
from keypush.reproduction.plan import Plan
from keypush.reproduction.throughput import timed
from keypush.rollout.job import Job
from keypush.rollout.make_engine import EngineName
from keypush.rollout.store import compare_description, finished_episodes


@dataclass(frozen=True, kw_only=True)
class Part:
    """One policy under one condition."""

    job: Job
    folder: Path
    """Of an evaluation; once that is finished its records and what was run."""
    name: str
    """Of the folder, relative to the reproduction's."""

    @property
    def policy(self) -> str:
        """Who drives."""
        return self.job.scenario.policy

    @property
    def finished(self) -> bool:
        """Whether its records stand."""
        return (self.folder / RECORDS_FILE).exists()

    @property
    def left(self) -> int:
        """Number of episodes that are still to run."""
        return 0 if self.finished else self.job.total - finished_episodes(self.job, self.folder)

    def run(self, *, workers: int, engine: EngineName) -> pa.Table:
        """Runs what is missing; keeps the records and drops the rows, which nothing else needs.

        Returns:
            The records, their folder relative to that of the reproduction.

        Raises:
            UserError: see `evaluate`, or its records are not those of this job.
            RuntimeError: an episode raised.
        """
        if self.finished:
            compare_description(self.job, self.folder)
        else:
            self._evaluate(workers, engine)
        for kind in ("rows", "episodes"):
            shutil.rmtree(self.folder / kind, ignore_errors=True)
        path = self.folder / RECORDS_FILE
        records = read_records(path)
        _check_records(records, self.job, path)
        place = records.schema.get_field_index("folder")
        names = pa.array([self.name] * len(records))
        return records.set_column(place, records.schema.field(place), names)

    def _evaluate(self, workers: int, engine: EngineName) -> None:
        with timed(self.job, self.folder, workers):
            run_conditions([self.job], self.folder, workers=workers, engine=engine)
        collect_records([self.job], self.folder)


def _check_records(records: pa.Table, job: Job, path: Path) -> None:
    """Compares who drove, what was pushed and how it was varied with a job.

    Raises:
        UserError: the records are of something else; names the file and the column.
    """
    if len(records) != job.total:
        raise UserError(
            f"{path}: has {len(records)} episodes; allowed: the {job.total} of this plan"
        )
    scenario, numbers = job.scenario, range(job.episodes)
    wanted: Mapping[str, Iterable[object]] = {
        "policy": [scenario.policy] * job.total,
        "object": [name for name in job.objects for _ in numbers],
        "episode": [*numbers] * len(job.objects),
        "seed": [scenario.seed] * job.total,
        "size_ratio": [scenario.object.size_ratio] * job.total,
        "com_shift": [scenario.variation.com_shift] * job.total,
        "cloud_deviation": [scenario.noise.cloud_deviation] * job.total,
        "push_speed": [scenario.planner.push_speed] * job.total,
    }
    for name, column in wanted.items():
        for row, (found, value) in enumerate(zip(records[name].to_pylist(), column, strict=True)):
            if found != value:
                raise UserError(
                    f"{path}: {name} of row {row} is {found!r}; allowed: {value!r}, as in this plan"
                )


def parts(plan: Plan, policies: Sequence[str], out: Path) -> Iterator[Part]:
    """Yields the parts in the order in which they run: a condition with every policy, the next.

    Raises:
        UserError: weights do not ship.
    """
    for jobs in zip(*(plan.jobs(policy) for policy in policies), strict=True):
        for job in jobs:
            name = f"{job.scenario.policy}/{condition_name(job.scenario)}"
            yield Part(job=job, folder=out / name, name=name)
