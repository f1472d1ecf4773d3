"""How the thesis' heads are trained on the tokens of a frozen encoder."""

from dataclasses import dataclass
from typing import override

from keypush.checked_fields import choice, number
from keypush.errors import UserError
from keypush.learning.config import DataConfig
from keypush.learning.run_config import PRECISIONS
from keypush.networks.config import WIDTH


@dataclass(kw_only=True)
class ImitationConfig(DataConfig):
    """Everything but data and encoder that decides a trained head."""

    rows_per_object: int = number(20_000, 0, 10**9)
    """Rows of each object that are trained on, drawn from all of its rows; 0: every row."""
    retreats: bool = False
    """behavior_cloning: whether rows in which the expert retreats are trained on; a hidden counter
    and not the scene decides when it does."""
    epochs: int = number(20, 1, 10_000)
    """Passes over these rows."""
    batch: int = number(256, 1, 65_536)
    """Rows per optimiser step."""
    learning_rate: float = number(2e-3, 1e-7, 1.0)
    """AdamW's rate at the beginning."""
    halve_every: int = number(4, 1, 10_000)
    """Epochs after which the rate is halved, again and again."""
    use_com: bool = True
    """Whether the true centre of mass is an input."""
    heads: int = number(8, 1, WIDTH)
    """Heads of the cross-attention: 8 or 16 in the thesis."""
    dropout: float = number(0.0, 0.0, 0.9)
    """Of the head; 0.1 in the thesis. It stands before a LayerNorm, whose input then varies more in
    training than in use, so that answers are off by an amount that changes from epoch to epoch."""
    cloud_deviation: float = number(0.005, 0.0, 0.1)
    """Standard deviation of every coordinate of a cloud, m."""
    clouds_per_object: int = number(256, 1, 100_000)
    """Noisy clouds drawn for every object and size, as far as it has rows for them."""
    cache: bool = True
    """Whether rows are encoded once, with one draw of the noise, and their tokens kept on disk;
    else every epoch draws anew and encodes anew, which costs ten times as much."""
    encoder_precision: str = choice("bf16", PRECISIONS)
    """Of the encoder's arithmetic; cached tokens are bfloat16 in either case."""

    @override
    def validate(self) -> None:
        """Checks every field's range.

        Raises:
            UserError: names the field, what it holds and what is allowed.
        """
        super().validate()
        if WIDTH % self.heads:
            raise UserError(f"heads is {self.heads}; allowed: divisors of {WIDTH}")

    def rate_after(self, epochs: float) -> float:
        """Returns the learning rate after this many epochs: halved again and again."""
        return float(self.learning_rate * 0.5 ** (int(epochs) // self.halve_every))
