"""Records examples of an evaluation, as a robotics paper shows them: successes and failures.

    scripts/uv.sh run scripts/record_examples.py RUN OUT [--objects NAME...] [--policy POLICY]

RUN is a folder of `keypush evaluate` or `keypush reproduce`, or POLICY/CONDITION in the latter.
The episodes are drawn by lot from its records, so that nobody picks what looks best, and run again,
which repeats them bit for bit. OUT/index.html links to their recordings, with pictures where
--stills is given; OUT/examples.md has the same table. Exit status 1 says that an episode did not
repeat its record, as with other weights or on another kind of machine.
"""

import io
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from PIL import Image
from stills import open_recordings, side_view, stills
from tqdm import tqdm

from keypush.atomic_file import write_whole
from keypush.cli.output import prepare_output_dir
from keypush.errors import UserError
from keypush.evaluation.examples import Choice, Example, choose_examples, record_example
from keypush.evaluation.examples_page import Gallery, render_markdown, render_page
from keypush.evaluation.records import RECORDS_FILE, read_records

_STILL = (300, 240)
_SHARPNESS = 1.5
_QUALITY = 78
_DISTANCE = 0.85
"""From the camera to the middle of the push, m: hand, object and goal are in view."""


@dataclass(kw_only=True)
class Options:
    """Record successes and failures of an evaluation as pages to watch."""

    run: tyro.conf.Positional[Path]
    """Folder with records.parquet."""
    out: tyro.conf.Positional[Path]
    """Folder for the pages, 6 MB each."""
    objects: Annotated[tuple[str, ...], tyro.conf.arg(metavar="NAME...")] = (
        "camera",
        "candle",
        "bumpy_toy",
    )
    """Objects; the default ones are those of the thesis' section 5.5."""
    policy: str | None = None
    """Who drove, where RUN has several policies."""
    most: int = 3
    """Successes, and failures, of every object."""
    seed: int = 0
    """Of the lots."""
    stills: bool = False
    """Put four pictures of every episode into the index; needs Chromium."""


def make_examples(options: Options) -> Gallery:
    """Draws, runs and records the episodes."""
    records = read_records(options.run / RECORDS_FILE)
    choices = choose_examples(
        records, options.objects, policy=options.policy, most=options.most, seed=options.seed
    )
    prepare_output_dir(options.out)
    groups: list[tuple[Choice, list[Example]]] = [(choice, []) for choice in choices]
    total = sum(len(choice.records) for choice in choices)
    with tqdm(total=total, unit="recordings", disable=None) as progress:
        for choice, examples in groups:
            for record in choice.records:
                examples.append(record_example(options.run, record, options.out))
                progress.update()
    made = [example for _, examples in groups for example in examples]
    told = next((record for choice in choices for record in choice.records), None)
    if told is None:
        raise UserError(f"{options.run / RECORDS_FILE}: has no episode of these objects")
    return Gallery(
        title=f"Examples of {told['policy']}",
        lead=(
            f"Drawn by lot (seed {options.seed}) from the records of an evaluation, scenario seed "
            f"{told['seed']}: {options.most} successes and {options.most} failures of every "
            "object, or as many as there are. Left and right are those of who looks from the "
            "centre of mass to the goal."
        ),
        groups=groups,
        stills=_pictures(made) if options.stills else {},
    )


def _pictures(examples: Sequence[Example]) -> dict[Path, list[bytes]]:
    """Returns JPEGs of each episode's moments."""
    pictures = {}
    with open_recordings(_STILL, _SHARPNESS) as page:
        for example in tqdm(examples, unit="episodes pictured", disable=None):
            told = example.record
            start, goal = (np.array([told[f"{at}_x"], told[f"{at}_y"]]) for at in ("start", "goal"))
            view = side_view(start, goal, _DISTANCE)
            found = stills(page, example.page, example.moments, view)
            pictures[example.page] = [_jpeg(picture) for picture in found]
    return pictures


def _jpeg(picture: Image.Image) -> bytes:
    file = io.BytesIO()
    picture.save(file, format="JPEG", quality=_QUALITY, optimize=True)
    return file.getvalue()


def main() -> int:
    """Writes recordings, index and Markdown; returns the exit status."""
    options = tyro.cli(Options, description=__doc__, config=(tyro.conf.FlagCreatePairsOff,))
    try:
        gallery = make_examples(options)
        write_whole(options.out / "index.html", render_page(gallery).encode())
        write_whole(options.out / "examples.md", render_markdown(gallery).encode())
    except UserError as error:
        print(f"record_examples: {error}", file=sys.stderr)
        return 2
    print(gallery.differing)
    print(f"written: {options.out / 'index.html'}")
    return int(any(example.differences for _, found in gallery.groups for example in found))


if __name__ == "__main__":
    sys.exit(main())
