"""The options that verbs share, and how they become a checked scenario."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro
import yaml

from keypush.errors import UserError
from keypush.field_tree import put_field
from keypush.policies import OWN_POLICY, POLICIES
from keypush.yaml_text import parse_yaml

if TYPE_CHECKING:
    from keypush.scenario import Scenario

Policy = Annotated[
    str | None,
    tyro.conf.arg(
        metavar="POLICY",
        help="Who drives the tool. "
        + "; ".join(f"{name}: {policy.description}" for name, policy in POLICIES.items())
        + f"; {OWN_POLICY}: a keypoint model of your own, a class or function of a Python file.",
    ),
]
"""The option `--policy`; the scenario checks its value."""
OBJECTS = "train|id|ood|unseen|user|all|NAME,..."
"""Stands in the help for a list of objects."""


@dataclass(kw_only=True)
class ScenarioOptions:
    """What an episode is made of."""

    scenario: Path | None = None
    """Scenario file (YAML); fields that it leaves out keep their defaults."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="FIELD=VALUE")] = ()
    """Fields of the scenario by their YAML names, such as noise.cloud_deviation=0.01."""
    seed: int | None = None
    """Root of every random draw."""


def resolve_scenario(options: ScenarioOptions, **fields: object) -> "Scenario":
    """Merges defaults, the scenario file, `--set` and a verb's own flags, in this order.

    Args:
        options: the shared options.
        fields: more fields by their YAML names, with `__` for the dot; None leaves a
            field as it is.

    Raises:
        UserError: a file cannot be read, a field is unknown or out of range.
    """
    from keypush.scenario import load_scenario, parse_scenario

    scenario = None if options.scenario is None else load_scenario(options.scenario)
    overrides: dict[str, Any] = {}
    for text in options.set:
        name, separator, value = text.partition("=")
        if not (name and separator):
            raise UserError(f"--set {text!r}: expected FIELD=VALUE")
        put_field(overrides, name, _parse_value(text, value))
    for name, field in {"seed": options.seed, **fields}.items():
        if field is not None:
            put_field(overrides, name.replace("__", "."), field)
    return parse_scenario(yaml.safe_dump(overrides), source="scenario", defaults=scenario)


def _parse_value(text: str, value: str) -> Any:
    try:
        return parse_yaml(value)
    except UserError as error:
        raise UserError(f"--set {text!r}: {error}") from error
