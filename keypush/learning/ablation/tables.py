"""The tables of the page: those of the thesis, of held-out objects and of encoders."""

from collections.abc import Sequence
from statistics import fmean

from keypush.learning.ablation.effects import ranked
from keypush.learning.ablation.findings import order_of_settings
from keypush.learning.ablation.markdown import (
    centimetres,
    describe,
    mean_curve,
    paragraph,
    table,
    variant,
)
from keypush.learning.ablation.results import Ablation, Training
from keypush.learning.ablation.settings import SETTINGS, SHOWN, Setting


def settings_section(ablation: Ablation, *, use_com: bool) -> list[str]:
    """Returns the table of one half of the settings, beside the thesis' 5.3 or 5.4."""
    order = ranked(ablation, use_com=use_com)
    thesis = sorted(order, key=lambda setting: setting.thesis_error)
    rows = [
        _row(ablation, setting, order, thesis) for setting in SETTINGS if setting.use_com == use_com
    ]
    head = (
        "model", "layers", "patch", "heads", "train error, 10⁻⁶", "validation error, cm",
        "other episodes of trained objects, cm", "rank", "thesis: train, 10⁻⁶",
        "thesis: validation", "thesis: rank",
    )  # fmt: skip
    return [
        f"## {variant(use_com=use_com).capitalize()} (table {'5.3' if use_com else '5.4'})",
        table(head, rows),
        order_of_settings(ablation, order[0], use_com=use_com),
    ]


def _row(
    ablation: Ablation, setting: Setting, order: Sequence[Setting], thesis: Sequence[Setting]
) -> list[str]:
    trainings = ablation.of(setting)
    error = centimetres(ablation.errors(setting))
    return [
        f"{setting.model}",
        f"{setting.shape.layers}",
        f"{setting.shape.patch_size}",
        f"{setting.heads}",
        f"{1e6 * fmean(one.epochs[-1].train_mse for one in trainings):.0f}",
        f"**{error}**" if setting == order[0] else error,
        centimetres([one.epochs[-1].validation_error for one in trainings]),
        f"{order.index(setting) + 1}",
        f"{1e6 * setting.thesis_train_error:.4f}",
        f"{setting.thesis_error:.4f}",
        f"{thesis.index(setting) + 1}",
    ]


def epochs_section(ablation: Ablation) -> list[str]:
    """Returns tables A.1 and A.2: every epoch of the thesis' best settings."""
    head = ("epoch", "train error, 10⁻⁶", "validation error, cm", "other episodes, cm",
            "learning rate")  # fmt: skip
    parts = []
    for name, setting in zip(("A.1", "A.2"), SHOWN, strict=True):
        told = f"{describe(setting)}, {variant(use_com=setting.use_com)}"
        parts += [
            f"### Table {name}: {told}",
            "Means over the seeds.",
            table(head, _epoch_rows(ablation.of(setting))),
        ]
    return [
        *parts,
        paragraph(
            "The thesis' table A.2 is headed model 2 and ends with the train error that its table "
            "5.4 gives for model 1."
        ),
    ]


def _epoch_rows(trainings: Sequence[Training]) -> list[list[str]]:
    columns = zip(
        mean_curve(trainings, lambda epoch: epoch.train_mse),
        mean_curve(trainings, lambda epoch: epoch.held_out_error),
        mean_curve(trainings, lambda epoch: epoch.validation_error),
        mean_curve(trainings, lambda epoch: epoch.learning_rate),
        strict=True,
    )
    return [
        [f"{i + 1}", f"{1e6 * mse:.1f}", f"{100 * error:.3f}", f"{100 * other:.3f}", f"{rate:.2e}"]
        for i, (mse, error, other, rate) in enumerate(columns)
    ]


def objects_section(ablation: Ablation) -> list[str]:
    """Returns the errors on each held-out object."""
    names = ablation.trainings[0].objects
    rows = []
    for shown in SHOWN:
        best = ranked(ablation, use_com=shown.use_com)[0]
        for setting in dict.fromkeys((shown, best)):
            values = [
                centimetres([one.objects[name] for one in ablation.of(setting)]) for name in names
            ]
            told = f"{describe(setting)}, {variant(use_com=setting.use_com)}"
            rows.append([told, *values])
    return [
        "## Held-out objects, one by one",
        "The thesis' best settings and ours, cm.",
        table(("setting", *(name.replace("_", " ") for name in names)), rows),
    ]


def encoders_section(ablation: Ablation) -> list[str]:
    """Returns how well the encoders tell patches in contact."""
    kinds = list(ablation.encoders[0].trained_objects)
    rows = [
        [
            f"{encoder.shape.layers}",
            f"{encoder.shape.patch_size}",
            *(f"{encoder.trained_objects[kind]:.3f}" for kind in kinds),
            *(f"{encoder.held_out_objects[kind]:.3f}" for kind in kinds),
        ]
        for encoder in ablation.encoders
    ]
    told = [
        f"{objects}, {kind.replace('_', ' ')}"
        for objects in ("trained objects", "held-out objects")
        for kind in kinds
    ]
    return [
        "## Encoders",
        "Average precision of the patches in contact, on new scenes.",
        table(("layers", "patch", *told), rows),
    ]
