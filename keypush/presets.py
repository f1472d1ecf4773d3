"""Settings that have a name: some fields of a configuration, where these are at their defaults."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from keypush.errors import UserError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def with_preset[Config: "DataclassInstance"](
    config: Config, what: str, presets: Mapping[str, Mapping[str, Any]], name: str
) -> Config:
    """Returns a configuration with the fields of a preset.

    Args:
        config: its fields stay what they are where they differ from the defaults. A field at its
            default counts as not given, since scenario files that were written hold every field.
        what: the preset's kind, for the message.
        presets: fields that differ from the defaults, by the preset's name.
        name: one of them.

    Raises:
        UserError: there is no such preset.
    """
    if name not in presets:
        raise UserError(f"{what} is {name!r}; allowed: {', '.join(presets)}")
    default = type(config)()
    wanted = {
        field: value
        for field, value in presets[name].items()
        if getattr(config, field) == getattr(default, field)
    }
    return replace(config, **wanted)
