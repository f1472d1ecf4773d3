"""What every training has in common; no torch is needed to read it."""

from dataclasses import dataclass

from keypush.checked_fields import choice, number
from keypush.scenario_check import LARGEST_SEED, check_values

PRECISIONS = ("32", "bf16")
ACCELERATORS = ("cpu", "gpu", "auto")


@dataclass(kw_only=True)
class RunConfig:
    """How a run goes; see `lightning_run`."""

    seed: int = number(0, 0, LARGEST_SEED)
    """Root of every random draw."""
    epochs: int = number(8, 1, 10_000)
    """Passes over the rows."""
    batch: int = number(256, 1, 65_536)
    """Rows per optimiser step."""
    learning_rate: float = number(1e-3, 1e-7, 1.0)
    """Peak of AdamW's rate."""
    weight_decay: float = number(0.01, 0.0, 10.0)
    """AdamW's weight decay."""
    patience: int = number(0, 0, 10_000)
    """Epochs without progress in validation after which training stops, and the best epoch's
    weights are kept; 0: never, and the last epoch's are."""
    precision: str = choice("32", PRECISIONS)
    """Of the arithmetic: single, or bfloat16 where that is safe."""
    accelerator: str = choice("cpu", ACCELERATORS)
    """What computes; auto: the best that is there."""
    devices: int = number(1, 1, 64)
    """How many of them; they share the rows of an epoch, and a step takes `batch` rows of each."""

    def validate(self) -> None:
        """Checks every field's range.

        Raises:
            UserError: names the field, what it holds and what is allowed.
        """
        check_values(self)
