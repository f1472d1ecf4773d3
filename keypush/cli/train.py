"""`keypush train`: networks from collected episodes."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Literal

from keypush.cli.data_option import check_data
from keypush.cli.output import prepare_output_dir
from keypush.errors import UserError
from keypush.learning.config import TrainingConfig
from keypush.learning.imitation.config import ImitationConfig
from keypush.rollout.folder_lock import hold_folder

_SHIPPED_ENCODER = "contact"
Network = Literal["surface_keypoint", "keypoint", "behavior_cloning"]


@dataclass(kw_only=True)
class Train:
    """Train a network on a data set.

    Writes OUT/NETWORK.safetensors, its card, checkpoints and logs; a stopped run goes on from its
    last epoch. See docs/learning.md.
    """

    after_interrupt: ClassVar[str] = "finished epochs are kept; the same command goes on from them"

    network: Network = "surface_keypoint"
    """surface_keypoint: chooses among the points of the cloud, trained as a whole. keypoint and
    behavior_cloning: the thesis' heads on a frozen encoder."""
    data: Path
    """Folder of a data set that `keypush collect` wrote."""
    out: Path
    """Folder for the weights."""
    encoder: str | None = None
    """keypoint and behavior_cloning: weights of the kind contact, by name or path; by default those
    that ship."""
    preset: Literal["affordable", "thesis"] = "affordable"
    """keypoint and behavior_cloning: the thesis' own settings or those that take minutes. Fields of
    --head that differ from their defaults go before; one at its default counts as not given."""
    surface: TrainingConfig = field(default_factory=TrainingConfig)
    """Settings of surface_keypoint."""
    head: ImitationConfig = field(default_factory=ImitationConfig)
    """Settings of keypoint and behavior_cloning."""

    def run(self) -> None:
        """Runs the verb."""
        self._check()
        out = prepare_output_dir(self.out)
        with hold_folder(out):
            metrics = self._train_surface(out) if self._is_surface else self._train_head(out)
        for name, value in metrics.items():
            if name != "history":
                print(f"{name}: {value}")
        print(f"written: {out / f'{self.network}.safetensors'}")

    @property
    def _is_surface(self) -> bool:
        return self.network == "surface_keypoint"

    def _check(self) -> None:
        check_data(self.data)
        of_heads = {
            "--encoder": self.encoder is not None,
            "--preset": self.preset != "affordable",
            "--head": self.head != ImitationConfig(),
        }
        of_others = (
            of_heads if self._is_surface else {"--surface": self.surface != TrainingConfig()}
        )
        foreign = [option for option, given in of_others.items() if given]
        if foreign:
            raise UserError(
                f"--network is {self.network}, which takes no {', '.join(foreign)}; allowed: "
                f"{'--surface' if self._is_surface else '--encoder, --preset, --head'}"
            )

    def _train_surface(self, out: Path) -> dict[str, Any]:
        self.surface.validate()
        from keypush.learning.train import train

        return train(self.data, out, self.surface)

    def _train_head(self, out: Path) -> dict[str, Any]:
        from keypush.learning.imitation.presets import preset_config

        config = preset_config(self.head, self.preset)
        config.validate()
        from keypush.learning.imitation.train import train_imitation
        from keypush.rollout.progress import say

        encoder = self.encoder or _SHIPPED_ENCODER
        return train_imitation(self.network, self.data, out, encoder, config, say)
