"""How the networks are trained that predict where to push."""

from dataclasses import dataclass, field
from typing import override

from keypush.checked_fields import choice, number
from keypush.errors import UserError
from keypush.learning.kinds import check_sizes
from keypush.learning.run_config import RunConfig
from keypush.networks.config import SurfaceConfig
from keypush.scenario_check import SURFACE_POINTS

LABELS = ("measured", "analytic")


@dataclass(kw_only=True)
class DataConfig(RunConfig):
    """What is learnt from a data set."""

    label: str = choice("measured", LABELS)
    """"measured": the contact that the push had; "analytic": the point that the expert aimed at."""
    keep_failures: bool = False
    """Whether episodes without success are trained on."""
    validation_share: float = number(0.1, 0.01, 0.9)
    """Share of the episodes that is kept for validation."""
    held_out_objects: list[str] = field(default_factory=list)
    """Objects that are only validated on."""


@dataclass(kw_only=True)
class TrainingConfig(DataConfig):
    """Everything but the data that decides a trained `SurfaceKeypointNetwork`."""

    epochs: int = number(8, 1, 10_000)
    """Passes; each draws new noise, new surface points and new augmentation."""
    rows_per_epoch: int = number(20_000, 1, 10**9)
    """Rows drawn per pass: neighbouring rows are much alike, so not all are needed."""
    batch: int = number(256, 1, 65_536)
    """Rows per optimiser step."""
    learning_rate: float = number(1e-3, 1e-7, 1.0)
    """Peak of AdamW's rate: linear warm-up over a twentieth of the steps, then cosine to 0."""
    max_gradient: float = number(1.0, 1e-6, 1e6)
    """Norm to which gradients are clipped."""
    augment: bool = True
    """Whether objects are mirrored, stretched, sheared, bent and tapered."""
    clouds_per_object: int = number(64, 1, 100_000)
    """Clouds drawn per pass for every object and size, as far as the pass has rows for them."""
    cloud_points: int = number(512, 16, SURFACE_POINTS)
    """Points of a cloud."""
    cloud_deviation: float = number(0.005, 0.0, 0.1)
    """Standard deviation of every coordinate of a cloud, m."""
    network: SurfaceConfig = field(default_factory=SurfaceConfig)
    """Sizes and inputs of the network."""

    @override
    def validate(self) -> None:
        """Checks every field's range, and that heads and patches fit.

        Raises:
            UserError: names the field, what it holds and what is allowed.
        """
        super().validate()
        network = self.network
        check_sizes(network, "network.")
        least = max(network.patches, network.patch_size)
        if self.cloud_points < least:
            raise UserError(f"cloud_points is {self.cloud_points}; allowed: at least {least}")
