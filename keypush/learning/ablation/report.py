"""The page that tells what an ablation found, beside the thesis' tables."""

from pathlib import Path

from keypush.atomic_file import write_whole
from keypush.errors import UserError, one_line
from keypush.learning.ablation.effects import ranked
from keypush.learning.ablation.findings import what_matters, when_stable
from keypush.learning.ablation.markdown import centimetres, describe, paragraph, variant
from keypush.learning.ablation.plots import draw_all, draw_best
from keypush.learning.ablation.results import Ablation
from keypush.learning.ablation.settings import SHOWN
from keypush.learning.ablation.tables import (
    encoders_section,
    epochs_section,
    objects_section,
    settings_section,
)


def write_report(ablation: Ablation, page: Path) -> None:
    """Writes the page, and its plots `PAGE_best.png` and `PAGE_all.png` beside it.

    Raises:
        UserError: a file cannot be written.
    """
    best, every = (page.with_name(f"{page.stem}_{name}.png") for name in ("best", "all"))
    try:
        page.parent.mkdir(parents=True, exist_ok=True)
        draw_best(ablation, best)
        draw_all(ablation, every)
    except OSError as error:
        raise UserError(f"{page}: its plots cannot be written: {one_line(error)}") from error
    parts = [
        *_introduction(ablation),
        *settings_section(ablation, use_com=True),
        *settings_section(ablation, use_com=False),
        *what_matters(ablation),
        *_curves(ablation, best, every),
        *epochs_section(ablation),
        *objects_section(ablation),
        *encoders_section(ablation),
    ]
    write_whole(page, ("\n\n".join(parts) + "\n").encode())


def summary(ablation: Ablation) -> list[str]:
    """Returns a line on the best setting with and without the centre of mass."""
    return [
        f"{variant(use_com=use_com)} the best is {describe(best)}: "
        f"{centimetres(ablation.errors(best))} cm on held-out objects"
        for use_com in (True, False)
        for best in ranked(ablation, use_com=use_com)[:1]
    ]


def _introduction(ablation: Ablation) -> list[str]:
    data, settings = (ablation.provenance[name] for name in ("data", "settings"))
    held_out = [name.replace("_", " ") for name in data["held_out_objects"]]
    trained = len(set(data["objects"]).difference(data["held_out_objects"]))
    scenes = settings["pretraining.epochs"] * settings["pretraining.samples_per_epoch"]
    return [
        "# Ablation",
        paragraph(
            "The settings of the thesis' tables 5.3 and 5.4: encoder layers, patch size, heads of "
            "the cross-attention, each with and without the centre of mass as an input. Every "
            "number of ours is computed from `ablation.json`, which was written by"
        ),
        f"    {' '.join(ablation.provenance['command'])}",
        paragraph(
            f"{trained} {'object is' if trained == 1 else 'objects are'} trained on "
            f"({data['trained_rows']} frames). {', '.join(held_out)} "
            f"{'is' if len(held_out) == 1 else 'are'} held out, from the "
            f"pretraining of the encoders ({scenes} scenes each) too. {_seeds(ablation)}"
        ),
        paragraph(
            "The validation error is the mean distance of the keypoint on the held-out objects "
            "after the last epoch. The thesis does not say the unit of its own, so that only the "
            "order can be compared. Train errors are mean squares of normalised coordinates; ours "
            "are taken while training, with dropout."
        ),
    ]


def _seeds(ablation: Ablation) -> str:
    seeds = " ".join(map(str, ablation.seeds))
    if len(ablation.seeds) == 1:
        return f"Each setting was trained once (seed {seeds}), so that there are no intervals."
    return (
        f"Each setting was trained {len(ablation.seeds)} times (seeds {seeds}); ± is the standard "
        "deviation over these. They differ in first weights, order and dropout of the heads; the "
        "frames and the encoder of a shape are the same, so that no interval here tells of "
        "another data set or another pretraining."
    )


def _curves(ablation: Ablation, best: Path, every: Path) -> list[str]:
    return [
        "## Epochs (figure 5.4)",
        f"![curves of the thesis' best settings]({best.name})",
        paragraph(
            "Lines are means over the seeds, bands reach from the least to the greatest. Training "
            "begins above the axes."
        ),
        *(when_stable(ablation, setting) for setting in SHOWN),
        f"![curves of all settings]({every.name})",
    ]
