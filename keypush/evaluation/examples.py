"""Examples of what was evaluated: chosen by a rule, run again, recorded as pages to watch."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from keypush.atomic_file import write_whole
from keypush.errors import UserError
from keypush.evaluation.conditions import condition_name
from keypush.evaluation.course import tell_course
from keypush.evaluation.measures import measure_rows
from keypush.evaluation.recorded_condition import VARIED, Family, make_condition
from keypush.evaluation.records import RECORDS
from keypush.recording.narration import final_distance
from keypush.recording.recorder import record_episode
from keypush.rollout.episode import EpisodeResult
from keypush.scenario import load_scenario
from keypush.seeding import make_generator

_TOLD = ("success", "settled_success", "outcome", "steps", "size_ratio", "com_capped")
"""What a record repeats of an episode's summary."""

MOMENTS = ("start", "before the first touch", "in the push", "end")
"""When an example is worth a look."""

Record = Mapping[str, Any]


@dataclass(frozen=True)
class Choice:
    """What was chosen of an object's successes, or of its failures."""

    object: str
    success: bool
    found: int
    """How many successes, or failures, there are to choose from."""
    episodes: int
    """How many episodes the object has."""
    records: tuple[Record, ...]
    """The chosen ones, in the order of conditions and episodes."""


@dataclass(frozen=True)
class Example:
    """An episode that was run again."""

    record: Record
    """As it was evaluated."""
    condition: str
    """What was not as usual, in words; empty where everything was."""
    end: str
    """When and where it ended."""
    course: str
    """How it went, on one line."""
    differences: tuple[str, ...]
    """Where it did not repeat its record; empty where it did."""
    page: Path
    """Plays it."""
    moments: tuple[float, ...]
    """Times of `MOMENTS`, s."""


def choose_examples(
    records: pa.Table, objects: Sequence[str], *, policy: str | None, most: int, seed: int
) -> list[Choice]:
    """Chooses records by lot, so that nobody picks what looks best.

    Args:
        records: rows of `RECORDS`.
        objects: names; all conditions in which they were pushed take part.
        policy: who drove; None where one policy alone did.
        most: successes, and failures, of every object.
        seed: of the lots; those of an object do not depend on the others.

    Raises:
        UserError: the policy or an object is not in the records, or there are several policies;
            a number is out of range.
    """
    if most < 1:
        raise UserError(f"--most is {most}; allowed: 1 or more")
    if seed < 0:
        raise UserError(f"--seed is {seed}; allowed: 0 or more")
    rows = records.to_pylist()
    policies = sorted({row["policy"] for row in rows})
    if policy is None and len(policies) > 1:
        raise UserError(f"--policy is missing; allowed: one of {', '.join(policies)}")
    if policy is not None and policy not in policies:
        raise UserError(f"--policy is {policy}; allowed: {', '.join(policies)}")
    mine = [row for row in rows if policy in (None, row["policy"])]
    names = sorted({row["object"] for row in mine})
    for name in objects:
        if name not in names:
            raise UserError(f"--objects has {name}; allowed: {', '.join(names)}")
        if objects.count(name) > 1:
            raise UserError(f"--objects has {name} twice; allowed: each once")
    return [
        _draw([row for row in mine if row["object"] == name], name, success, most, seed)
        for name in objects
        for success in (True, False)
    ]


def _draw(rows: Sequence[Record], name: str, success: bool, most: int, seed: int) -> Choice:
    found = [row for row in rows if row["success"] == success]
    found.sort(key=lambda row: (row["folder"], row["episode"]))
    generator = make_generator(seed, 0, f"examples:{name}:{success}")
    lots = generator.permutation(len(found))[:most]
    records = tuple(found[lot] for lot in sorted(lots))
    return Choice(name, success, len(found), len(rows), records)


def record_example(run: Path, record: Record, out: Path) -> Example:
    """Runs an episode again and writes the page OUT/OBJECT-EPISODE.html.

    Where the condition is unusual, its name stands after that.

    Args:
        run: folder of the evaluation or reproduction.
        record: one of its records.
        out: where the page goes.

    Raises:
        UserError: the scenario is missing or does not fit, or the page cannot be written.
        RuntimeError: the simulation failed, or no port is free.
    """
    scenario = load_scenario(run / record["folder"] / "scenario.yaml")
    scenario = replace(scenario, object=replace(scenario.object, name=record["object"]))
    recording = record_episode(scenario, record["episode"])
    condition = _condition(record)
    suffix = f"-{condition_name(scenario)}" if condition else ""
    page = out / f"{record['object']}-{record['episode']}{suffix}.html"
    write_whole(page, recording.html.encode())
    result = recording.result
    return Example(
        record=record,
        condition=condition,
        end=_end(result),
        course=tell_course(result.summary, result.rows),
        differences=tuple(compare(record, result)),
        page=page,
        moments=_moments(result),
    )


def compare(record: Record, result: EpisodeResult) -> Iterator[str]:
    """Yields where an episode that was run again differs from its record, in words."""
    x, y = np.asarray(result.summary["final_position"])[:2]
    again = {name: result.summary[name] for name in _TOLD}
    again |= {**measure_rows(result.rows), "final_x": x, "final_y": y}
    for name, value in again.items():
        now = pa.scalar(value, RECORDS.field(name).type).as_py()  # many are in single precision
        both_nan = record[name] != record[name] and now != now
        if record[name] != now and not both_nan:
            yield f"{name} was {_brief(record[name])}, is {_brief(now)}"


def _brief(value: object) -> str:
    """Nine digits tell all numbers of single precision apart."""
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _condition(record: Record) -> str:
    condition = make_condition(*(record[name] for name in VARIED))
    return "" if condition.family == Family.NOMINAL else condition.words


def _end(result: EpisodeResult) -> str:
    told = str(result.summary["outcome"]).replace("_", " ")
    held = not result.summary["success"] or result.summary["settled_success"]
    distance = f"{100 * final_distance(result):.1f} cm from the goal"
    return (
        f"{told}{'' if held else ', not held,'} after {result.summary['steps']} steps, {distance}"
    )


def _moments(result: EpisodeResult) -> tuple[float, ...]:
    times = np.asarray(result.rows["time"], dtype=float)
    touches = np.flatnonzero(np.isfinite(result.rows["contact_point"]).all(axis=1))
    last = len(times) - 1
    first, final = (touches[0], touches[-1]) if len(touches) else (last // 3, last)
    steps = (0, max(0, first - 1), (first + final) // 2, last)
    return tuple(float(times[step]) for step in steps)
