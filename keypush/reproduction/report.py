"""`tables.md`, `summary.json` and `speed.md` of a reproduction."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from keypush.atomic_file import write_whole
from keypush.objects.catalogue import SPLITS, catalogue_names
from keypush.reproduction.comparisons import (
    Comparison,
    Results,
    shifted_sets,
    shifted_table,
    size_table,
)
from keypush.reproduction.plan import Plan
from keypush.reproduction.tables import comparison_table, measures_table, throughput_table
from keypush.reproduction.thesis_figures import SIZE_TABLES
from keypush.reproduction.throughput import Session
from keypush.seeding import EVALUATION_SEEDS

TABLES_FILE = "tables.md"
SUMMARY_FILE = "summary.json"
SPEED_FILE = "speed.md"
_SETS = {
    "train": "training objects",
    "id": "novel objects similar to those (ID)",
    "ood": "novel objects unlike them (OOD)",
}
_NO_ABLATION = (
    "Not run. `keypush ablate --data DATA --out ABLATION` trains its settings; after that the same "
    "`keypush reproduce` with `--ablation ABLATION` puts the tables here."
)
_SPEED = """# How long it took

Episodes per second of wall time, over all starts of the command and with the start of its workers.

"""


@dataclass(frozen=True, kw_only=True)
class Reproduction:
    """What has been run so far."""

    plan: Plan
    policies: Sequence[str]
    """In the order of the tables."""
    left: Sequence[str]
    """Evaluations that are still to run, as POLICY/CONDITION."""
    records: pa.Table
    """Of all finished evaluations."""
    sessions: Mapping[str, Sequence[Session]]
    """By policy."""
    ablation: str | None
    """What to say of it; None where none is given."""


@dataclass(frozen=True, kw_only=True)
class _Section:
    """A table of comparisons."""

    number: str
    """The thesis'; "com" for our own."""
    title: str
    first: str
    """Heading of its column of conditions."""
    lines: Sequence[Comparison]


def write_reproduction(found: Reproduction, out: Path) -> None:
    """Writes `tables.md` and `summary.json`, the same for the same episodes, and `speed.md`.

    Raises:
        UserError: a file cannot be written.
    """
    results = Results(found.records, found.policies)
    sections = _sections(results, found.plan)
    text = render(found, results, sections)
    write_whole(out / TABLES_FILE, text.encode())
    report = _describe(found, sections)
    write_whole(out / SUMMARY_FILE, (json.dumps(report, indent=2) + "\n").encode())
    # In a file of its own: it alone differs from run to run.
    write_whole(out / SPEED_FILE, f"{_SPEED}{throughput_table(found.sessions)}\n".encode())


def render(found: Reproduction, results: Results, sections: Sequence[_Section]) -> str:
    """Returns the Markdown of `tables.md`."""
    parts = [_introduction(found, results)]
    for section in sections:
        parts += [f"## {section.title}", comparison_table(section.first, section.lines)]
    parts += [
        "## What else was measured",
        "All objects of the tables above in their own size, centre of mass where it is.",
        measures_table(results, found.plan.objects),
        "## Tables 5.3, 5.4, A.1, A.2 and figure 5.4: the ablation",
        found.ablation or _NO_ABLATION,
    ]
    return "\n\n".join(parts) + "\n"


def _introduction(found: Reproduction, results: Results) -> str:
    plan = found.plan
    names = {group: _mine(plan.objects, group) for group in SPLITS}
    told = "; ".join(
        f"{len(mine)} of {len(catalogue_names(group))} `{group}`"
        + ("" if len(mine) == len(catalogue_names(group)) else f" ({', '.join(mine)})")
        for group, mine in names.items()
    )
    left = f" {_left(found.left)} still to run." if found.left else ""
    return f"""# The thesis' tables, run anew

{results.episodes} episodes: {plan.episodes} of every object and condition, the same ones for every
policy (scenario seed {EVALUATION_SEEDS}, episodes 0 to {plan.episodes - 1}). Objects: {told}.{left}

"thesis" is its figure, "ours" our success rate with its 95 % Wilson interval in %, the difference
is in percentage points, N the number of our episodes. The thesis has three of the policies."""


def _left(names: Sequence[str]) -> str:
    return f"{names[0]} is" if len(names) == 1 else f"{len(names)} evaluations are"


def _sections(results: Results, plan: Plan) -> list[_Section]:
    sizes = [
        _Section(
            number=number,
            title=f"Table {number}: object sizes, {_SETS[group]}",
            first="size",
            lines=size_table(results, plan, group, _mine(plan.objects, group)),
        )
        for group, (number, _) in SIZE_TABLES.items()
    ]
    shifted = {group: _mine(plan.shifted, group) for group in SPLITS}
    return [
        *sizes,
        _Section(
            number="5.8",
            title="Table 5.8: centre of mass shifted by 1.5 cm",
            first="object",
            lines=shifted_table(results),
        ),
        _Section(
            number="com",
            title="Centre of mass shifted by 1.5 cm, by set of objects",
            first="objects",
            lines=shifted_sets(results, shifted),
        ),
    ]


def _mine(objects: Sequence[str], group: str) -> list[str]:
    return [name for name in catalogue_names(group) if name in objects]


def _describe(found: Reproduction, sections: Sequence[_Section]) -> dict[str, Any]:
    return {
        "plan": asdict(found.plan),
        "seed": EVALUATION_SEEDS,
        "policies": list(found.policies),
        "left": list(found.left),
        "episodes": len(found.records),
        "tables": {
            section.number: [line.describe() for line in section.lines] for section in sections
        },
    }
