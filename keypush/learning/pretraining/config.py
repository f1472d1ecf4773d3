"""How the contact network is pretrained; no torch is needed to read it."""

from dataclasses import dataclass, field
from typing import override

from keypush.checked_fields import choice, number
from keypush.learning.kinds import check_sizes
from keypush.learning.run_config import PRECISIONS, RunConfig
from keypush.networks.config import EncoderConfig


@dataclass(kw_only=True)
class PretrainConfig(RunConfig):
    """Everything but the objects that decides a pretrained `ContactNetwork`."""

    encoder: EncoderConfig = field(default_factory=EncoderConfig)
    """Sizes of the encoder."""
    epochs: int = number(50, 1, 100_000)
    """Times that new scenes are drawn; after each, the state is kept and the network measured."""
    samples_per_epoch: int = number(20_480, 1, 10**8)
    """Scenes drawn each time; no scene is seen twice."""
    precision: str = choice("bf16", PRECISIONS)
    """Of the arithmetic: single, or bfloat16 where that is safe."""
    learning_rate: float = number(1e-3, 1e-7, 1.0)
    """Peak of AdamW's rate: linear warm-up over a twentieth of the steps, then cosine to 0."""
    weight_decay: float = number(5e-4, 0.0, 10.0)
    """AdamW's weight decay."""
    max_gradient: float = number(4.0, 1e-6, 1e6)
    """Norm to which gradients are clipped."""
    positive_weight: float = number(1.0, 0.01, 100.0)
    """Weight in the loss of patches in contact; 1 keeps the probabilities honest."""
    task_share: float = number(0.3, 0.0, 1.0)
    """Share of scenes that look like the task: stable poses on the table, a pitched hand."""
    size_variation: float = number(0.25, 0.0, 0.5)
    """Objects are scaled by a factor between 1 less this and 1 plus this."""
    overlap_mean: float = number(0.03, -0.2, 0.2)
    """How far an object is moved on into the gripper after they touch, on average, m."""
    overlap_deviation: float = number(0.05, 0.0, 0.2)
    """Standard deviation of that, m."""
    shift_deviation: float = number(0.1, 0.0, 1.0)
    """Standard deviation of the shift of a whole random scene along every axis, m."""
    cloud_deviation: float = number(0.005, 0.0, 0.1)
    """Standard deviation of every coordinate of a cloud, m."""
    clouds_per_object: int = number(256, 1, 100_000)
    """Clouds and sizes drawn per epoch for every object, as far as it has scenes for them."""
    validation_samples: int = number(4096, 1, 10**6)
    """Scenes that the network is measured on, for each set of objects."""
    held_out_objects: list[str] = field(default_factory=list)
    """Objects that are only measured on."""

    @override
    def validate(self) -> None:
        """Checks every field's range, and the sizes of the encoder.

        Raises:
            UserError: names the field, what it holds and what is allowed.
        """
        super().validate()
        check_sizes(self.encoder, "encoder.")
