"""What decides an ablation; no torch is needed to read it."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from keypush.checked_fields import number
from keypush.errors import UserError
from keypush.learning.ablation.settings import Setting, Shape
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.pretraining.config import PretrainConfig
from keypush.objects.catalogue import catalogue_names
from keypush.scenario_check import LARGEST_SEED

SEEDS = (0, 1, 2)


@dataclass(kw_only=True)
class AblationHead(ImitationConfig):
    """Settings of every head."""

    seed: int = number(0, 0, LARGEST_SEED)
    """Draws rows and clouds, which are the same for all settings and `seeds`."""
    rows_per_object: int = number(10_000, 0, 10**9)
    """Rows of each object that are trained on, drawn from all of its rows; 0: every row."""
    batch: int = number(1024, 1, 65_536)
    """Rows per optimiser step."""
    learning_rate: float = number(4e-3, 1e-7, 1.0)
    """AdamW's rate at the beginning."""
    dropout: float = number(0.1, 0.0, 0.9)
    """Of the head, as in the thesis."""


_SET_BY_ABLATION: Mapping[type, tuple[str, ...]] = {
    AblationHead: (
        "heads", "use_com", "held_out_objects", "cache", "patience", "accelerator", "devices",
    ),
    PretrainConfig: (
        "encoder.layers", "encoder.patch_size", "held_out_objects", "patience", "accelerator",
        "devices",
    ),
}  # fmt: skip
"""Fields that keep their defaults: the ablation varies them, or every run has to be like the
others and beside them."""


@dataclass(kw_only=True)
class AblationConfig:
    """Everything but the data that decides an ablation."""

    seeds: tuple[int, ...] = SEEDS
    """Of the heads: their first weights, the order of rows, dropout."""
    held_out_objects: tuple[str, ...] = ()
    """Objects that nothing is trained on; empty: the catalogue's 4 of 16."""
    head: AblationHead = field(default_factory=AblationHead)
    """Of every head."""
    pretraining: PretrainConfig = field(default_factory=PretrainConfig)
    """Of every encoder."""

    def validate(self) -> None:
        """Checks every field.

        Raises:
            UserError: names the field, what it holds and what is allowed.
        """
        good = self.seeds and min(self.seeds) >= 0 and max(self.seeds) <= LARGEST_SEED
        if not good or len(set(self.seeds)) < len(self.seeds):
            found = " ".join(map(str, self.seeds)) or "empty"
            raise UserError(
                f"seeds is {found}; allowed: whole numbers from 0 to {LARGEST_SEED}, each once"
            )
        for section in ("head", "pretraining"):
            config = getattr(self, section)
            _check_kept(section, config)
            config.validate()

    @property
    def held_out(self) -> list[str]:
        """The objects that nothing is trained on."""
        return list(self.held_out_objects) or catalogue_names("ablation_validation")

    @property
    def rows(self) -> ImitationConfig:
        """Settings that choose and encode the rows, with the centre of mass."""
        return dataclasses.replace(self.head, held_out_objects=self.held_out)

    def of_head(self, setting: Setting, seed: int) -> ImitationConfig:
        """Settings of one training."""
        return dataclasses.replace(
            self.rows, seed=seed, heads=setting.heads, use_com=setting.use_com
        )

    def of_encoder(self, shape: Shape) -> PretrainConfig:
        """Settings of one pretraining."""
        sizes = dataclasses.replace(
            self.pretraining.encoder, layers=shape.layers, patch_size=shape.patch_size
        )
        return dataclasses.replace(self.pretraining, encoder=sizes, held_out_objects=self.held_out)

    def identity(self) -> dict[str, Any]:
        """What decides the numbers of a training whose setting and seed are known."""
        fields = {
            f"{section}.{name}": value
            for section in ("head", "pretraining")
            for name, value in dataclasses.asdict(getattr(self, section)).items()
        }
        return {**fields, "held_out_objects": self.held_out}


def _check_kept(section: str, config: Any) -> None:
    default = type(config)()
    for name in _SET_BY_ABLATION[type(config)]:
        found, kept = (_field(each, name) for each in (config, default))
        if found != kept:
            raise UserError(
                f"{section}.{name} is {found!r}; allowed: {kept!r}, because the ablation sets it"
            )


def _field(config: Any, dotted: str) -> Any:
    for name in dotted.split("."):
        config = getattr(config, name)
    return config
