"""The 16 settings of the ablation, and what the thesis found for each (tables 5.3 and 5.4)."""

from dataclasses import dataclass
from itertools import product

LAYERS = (2, 3)
PATCH_SIZES = (32, 16)
HEADS = (8, 16)


@dataclass(frozen=True, order=True, kw_only=True)
class Shape:
    """What an encoder of the ablation looks like."""

    layers: int
    patch_size: int

    @property
    def name(self) -> str:
        """As a folder is called."""
        return f"layers{self.layers}_patch{self.patch_size}"


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A row of table 5.3 (with the centre of mass) or 5.4 (without)."""

    shape: Shape
    """Of the encoder."""
    heads: int
    """Of the cross-attention."""
    use_com: bool
    """Whether the head is told the centre of mass."""

    @property
    def model(self) -> int:
        """Its number in the thesis' tables, 1 to 8."""
        place = LAYERS.index(self.shape.layers) * 2 + PATCH_SIZES.index(self.shape.patch_size)
        return 2 * place + HEADS.index(self.heads) + 1

    @property
    def name(self) -> str:
        """As a file is called."""
        return f"{self.shape.name}_heads{self.heads}_{'com' if self.use_com else 'no_com'}"

    @property
    def thesis_error(self) -> float:
        """The thesis' validation error on held-out objects, of which it does not say the unit."""
        return _VALIDATION[self.use_com][self.model - 1]

    @property
    def thesis_train_error(self) -> float:
        """The thesis' train error, a mean square."""
        return 1e-6 * _TRAIN[self.use_com][self.model - 1]


SHAPES = tuple(Shape(layers=n, patch_size=k) for n, k in product(LAYERS, PATCH_SIZES))
SETTINGS = tuple(
    Setting(shape=shape, heads=heads, use_com=com)
    for com, shape, heads in product((True, False), SHAPES, HEADS)
)
"""With the centre of mass first, each half in the order of the thesis' tables."""

_VALIDATION = {
    True: (0.1034, 0.1494, 0.0838, 0.1017, 0.1185, 0.0960, 0.1052, 0.0821),
    False: (0.1585, 0.1375, 0.4317, 0.2522, 0.3065, 0.4241, 0.3566, 0.2854),
}
_TRAIN = {
    True: (0.0678, 0.0620, 0.0748, 0.0622, 0.0639, 0.0400, 0.0688, 0.0490),
    False: (0.3045, 0.2055, 2.2314, 1.2106, 2.1039, 1.7595, 1.5396, 1.3708),
}


def setting_of(*, model: int, use_com: bool) -> Setting:
    """Returns the setting with a number in the thesis' tables."""
    return SETTINGS[(0 if use_com else len(SETTINGS) // 2) + model - 1]


SHOWN = (setting_of(model=8, use_com=True), setting_of(model=2, use_com=False))
"""The thesis' best, whose epochs it tells in figure 5.4 and tables A.1 and A.2."""
