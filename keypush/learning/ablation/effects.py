"""Which factor matters: main effects over the settings, with intervals over the seeds."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import fmean

import numpy as np
from scipy import stats

from keypush.learning.ablation.results import Ablation
from keypush.learning.ablation.settings import HEADS, LAYERS, PATCH_SIZES, SETTINGS, Setting


@dataclass(frozen=True, kw_only=True)
class Effect:
    """What changing one thing does to the error on held-out objects, other things being equal.

    Attributes:
        what: is changed.
        mean: of the change over the seeds, m.
        interval: 95 % interval of it, m; None with a single seed.
        thesis: the same of the thesis' figures, in its unit.
    """

    what: str
    mean: float
    interval: tuple[float, float] | None
    thesis: float

    @property
    def is_told_from_zero(self) -> bool:
        """Whether the interval leaves zero out."""
        return self.interval is not None and not self.interval[0] <= 0 <= self.interval[1]


@dataclass(frozen=True)
class _Contrast:
    """Settings with a change and those without, which have everything else in common."""

    what: str
    changed: Sequence[Setting]
    others: Sequence[Setting]

    def of(self, error: Callable[[Setting], float]) -> float:
        return fmean(map(error, self.changed)) - fmean(map(error, self.others))


def find_effects(ablation: Ablation) -> list[Effect]:
    """Returns the effect of the centre of mass, and those of the sizes with it and without it."""
    return [_effect(contrast, ablation) for contrast in _contrasts()]


def ranked(ablation: Ablation, *, use_com: bool) -> list[Setting]:
    """Returns the settings of a variant, the one with the least mean error first."""
    return sorted(_of_variant(use_com), key=lambda setting: fmean(ablation.errors(setting)))


def deviation(values: Sequence[float]) -> float:
    """Returns the standard deviation of a sample, NaN of a single value."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else float("nan")


def order_beside_thesis(ablation: Ablation, *, use_com: bool) -> float:
    """Returns Spearman's rank correlation of our mean errors with the thesis'."""
    settings = _of_variant(use_com)
    ours = [fmean(ablation.errors(setting)) for setting in settings]
    return _rank_correlation(ours, [setting.thesis_error for setting in settings])


def order_between_seeds(ablation: Ablation, *, use_com: bool) -> float | None:
    """Returns the mean rank correlation of two seeds' errors; None with a single seed."""
    by_seed = zip(*(ablation.errors(setting) for setting in _of_variant(use_com)), strict=True)
    pairs = [_rank_correlation(one, other) for one, other in combinations(by_seed, 2)]
    return fmean(pairs) if pairs else None


def _of_variant(use_com: bool) -> list[Setting]:
    return [setting for setting in SETTINGS if setting.use_com == use_com]


def _rank_correlation(one: Sequence[float], other: Sequence[float]) -> float:
    return float(stats.spearmanr(one, other).statistic)


def _effect(contrast: _Contrast, ablation: Ablation) -> Effect:
    def change(place: int) -> float:
        return contrast.of(lambda setting: ablation.errors(setting)[place])

    changes = [change(place) for place in range(len(ablation.seeds))]
    return Effect(
        what=contrast.what,
        mean=fmean(changes),
        interval=_interval95(changes),
        thesis=contrast.of(lambda setting: setting.thesis_error),
    )


def _interval95(values: Sequence[float]) -> tuple[float, float] | None:
    """Student's interval of the mean."""
    if len(values) < 2:
        return None
    half = stats.t.ppf(0.975, len(values) - 1) * deviation(values) / np.sqrt(len(values))
    return fmean(values) - float(half), fmean(values) + float(half)


def _contrasts() -> Iterator[_Contrast]:
    yield _split("told the centre of mass", SETTINGS, lambda setting: setting.use_com)
    for use_com, variant in ((True, "with it"), (False, "without it")):
        here = _of_variant(use_com)
        yield _split(f"{variant}: {LAYERS[1]} layers", here, _is_deep)
        yield _split(f"{variant}: patches of {PATCH_SIZES[1]}", here, _is_fine)
        yield _split(f"{variant}: {HEADS[1]} heads", here, _has_many_heads)
        for depth in LAYERS:
            some = [setting for setting in here if setting.shape.layers == depth]
            yield _split(f"{variant}: {HEADS[1]} heads at {depth} layers", some, _has_many_heads)


def _is_deep(setting: Setting) -> bool:
    return setting.shape.layers == LAYERS[1]


def _is_fine(setting: Setting) -> bool:
    return setting.shape.patch_size == PATCH_SIZES[1]


def _has_many_heads(setting: Setting) -> bool:
    return setting.heads == HEADS[1]


def _split(
    what: str, settings: Sequence[Setting], is_changed: Callable[[Setting], bool]
) -> _Contrast:
    changed = [setting for setting in settings if is_changed(setting)]
    return _Contrast(what, changed, [setting for setting in settings if setting not in changed])
