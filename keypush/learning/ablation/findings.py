"""What an ablation says, in sentences that are computed from its numbers."""

from collections.abc import Sequence

from keypush.learning.ablation.effects import (
    Effect,
    find_effects,
    order_beside_thesis,
    order_between_seeds,
)
from keypush.learning.ablation.markdown import describe, mean_curve, paragraph, table, variant
from keypush.learning.ablation.results import Ablation
from keypush.learning.ablation.settings import Setting

_CRITICAL_ORDER = 0.738
"""Spearman's correlation of eight pairs that chance exceeds in 5 % of cases, two-sided.
Source: Zar, "Biostatistical Analysis", table B.20."""
_STABLE = 0.05
"""So far from its last value, as a share of it, a curve counts as stable."""


def order_of_settings(ablation: Ablation, best: Setting, *, use_com: bool) -> str:
    """Tells the best setting and compares the order with the thesis'."""
    ours = order_beside_thesis(ablation, use_com=use_com)
    verdict = "beyond" if abs(ours) > _CRITICAL_ORDER else "within"
    seeds = order_between_seeds(ablation, use_com=use_com)
    between = "" if seeds is None else f"Between two of our own seeds it is {seeds:.2f} on average."
    return paragraph(
        f"Bold: our best, {describe(best)}. Spearman's rank correlation of our order with the "
        f"thesis' is {ours:.2f}, which is {verdict} what chance gives eight settings in 95 % of "
        f"cases (±{_CRITICAL_ORDER}). {between}"
    )


def what_matters(ablation: Ablation) -> list[str]:
    """Returns the section on the effects of each factor."""
    effects = find_effects(ablation)
    rows = [
        [
            effect.what,
            f"{1e3 * effect.mean:+.2f}",
            _interval(effect),
            f"{effect.thesis:+.4f}",
            "yes" if _agrees(effect) else "no",
        ]
        for effect in effects
    ]
    head = ("change", "ours, mm", "95 % interval, mm", "thesis' figures", "same sign")
    return [
        "## What matters",
        paragraph(
            "How the validation error changes when one thing is changed and the others are "
            "averaged over; negative is better. Layers are 3 instead of 2, patches 16 points "
            'instead of 32, heads 16 instead of 8; "it" is the centre of mass.'
        ),
        table(head, rows),
        paragraph(_sentences(effects, ablation)),
    ]


def when_stable(ablation: Ablation, setting: Setting) -> str:
    """Tells from which epoch on the validation error hardly changes."""
    curve = mean_curve(ablation.of(setting), lambda epoch: epoch.held_out_error)
    last = curve[-1]
    far = [i for i, error in enumerate(curve) if abs(error - last) > _STABLE * last]
    least = curve.index(min(curve))
    return paragraph(
        f"{describe(setting).capitalize()}, {variant(use_com=setting.use_com)}: the validation "
        f"error stays within {_STABLE:.0%} of its last value from epoch "
        f"{far[-1] + 2 if far else 1} of {len(curve)} on. It is least, {100 * curve[least]:.3f} "
        f"cm, in epoch {least + 1}; in the last it is {100 * last:.3f} cm."
    )


def _sentences(effects: Sequence[Effect], ablation: Ablation) -> str:
    text = (
        f"{sum(map(_agrees, effects))} of {len(effects)} changes go the way that they go in the "
        "thesis' figures."
    )
    if len(ablation.seeds) == 1:
        return f"{text} With one seed none of ours can be told from chance."
    told = sorted((e for e in effects if e.is_told_from_zero), key=lambda e: -abs(e.mean))
    if not told:
        return f"{text} None of ours can be told from 0 by these seeds."
    named = "; ".join(
        f"{effect.what} ({'lowers' if effect.mean < 0 else 'raises'} the error by "
        f"{1e3 * abs(effect.mean):.2f} mm)"
        for effect in told
    )
    return (
        f"{text} Told from 0 by these seeds, the largest first: {named}. "
        f"The other {len(effects) - len(told)} are not. Each interval is that of one comparison: "
        f"none is wider because there are {len(effects)} of them, so that chance alone may tell "
        "one from 0."
    )


def _agrees(effect: Effect) -> bool:
    return effect.mean * effect.thesis > 0


def _interval(effect: Effect) -> str:
    if effect.interval is None:
        return ""
    low, high = effect.interval
    return f"{1e3 * low:+.2f} to {1e3 * high:+.2f}"
