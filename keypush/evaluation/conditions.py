"""Conditions of an evaluation: one scenario in several sizes, shifts of mass and noises."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from keypush.errors import UserError
from keypush.scenario import Scenario


@dataclass(frozen=True)
class Axis:
    """A field of the scenario that differs between conditions."""

    option: str
    """The command line's."""
    word: str
    """In names of conditions."""
    section: str
    field: str

    @property
    def name(self) -> str:
        """The field's YAML name."""
        return f"{self.section}.{self.field}"

    def value(self, scenario: Scenario) -> float:
        """Returns what a scenario has."""
        return _unsigned_zero(getattr(getattr(scenario, self.section), self.field))

    def put(self, scenario: Scenario, value: float) -> Scenario:
        """Returns the scenario with another value.

        Raises:
            UserError: it is out of range; names the option.
        """
        section = replace(getattr(scenario, self.section), **{self.field: _unsigned_zero(value)})
        changed = replace(scenario, **{self.section: section})
        try:
            changed.validate()
        except UserError as error:
            raise UserError(f"--{self.option}: {error}") from error
        return changed


AXES = (
    Axis("sizes", "size", "object", "size_ratio"),
    Axis("com-shifts", "shift", "variation", "com_shift"),
    Axis("cloud-noise", "noise", "noise", "cloud_deviation"),
)


def grid(scenario: Scenario, values: Mapping[str, Sequence[float]]) -> list[Scenario]:
    """Returns the scenarios of all combinations.

    Args:
        scenario: its own value stands where an axis has none.
        values: of the axes, by their options.

    Raises:
        UserError: a value is out of range or given twice; names the option.
    """
    return list(_grid(scenario, [(axis, _checked(axis, scenario, values)) for axis in AXES]))


def condition_name(scenario: Scenario) -> str:
    """Returns the name of a scenario's condition, as in "size_0.75-shift_0-noise_0.005"."""
    return "-".join(f"{axis.word}_{number_text(axis.value(scenario))}" for axis in AXES)


def _grid(scenario: Scenario, axes: Sequence[tuple[Axis, Sequence[float]]]) -> Iterator[Scenario]:
    for combination in product(*(values for _, values in axes)):
        changed = scenario
        for (axis, _), value in zip(axes, combination, strict=True):
            changed = axis.put(changed, value)
        yield changed


def _checked(
    axis: Axis, scenario: Scenario, values: Mapping[str, Sequence[float]]
) -> Sequence[float]:
    given = values.get(axis.option) or [axis.value(scenario)]
    texts = [number_text(_unsigned_zero(value)) for value in given]
    for text in texts:
        if texts.count(text) > 1:
            raise UserError(f"--{axis.option} has {text} twice; allowed: each value once")
    return given


def _unsigned_zero(value: float) -> float:
    """The number itself, 0.0 for -0.0: they are one condition."""
    return float(value) + 0.0


def number_text(value: float) -> str:
    """What varies between conditions, with as many digits as tell two of them apart."""
    return f"{value:.12g}"
