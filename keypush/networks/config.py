"""Sizes of the networks, apart from them: reading a configuration needs no torch."""

from collections.abc import Mapping
from dataclasses import dataclass, field

WIDTH = 128
"""Size of every token (thesis, table 5.2)."""
CLOUD_POINTS = 512
"""Points of the cloud; patch size times number of patches."""
HAND_SIZE = 9
"""Of the hand state: tool position (3) and the first two columns of its rotation (6)."""
LARGEST: Mapping[str, int] = {
    "patches": 16_384,
    "patch_size": 16_384,
    "width": 2048,
    "patch_width": 2048,
    "point_width": 2048,
    "layers": 16,
}
"""Sizes that a card may tell: one that is wrong must not fill the memory before it is found out."""
DROPOUT_RANGE = (0.0, 0.9)


@dataclass(frozen=True, kw_only=True)
class EncoderConfig:
    """A `PatchTransformerEncoder` (CORN's, with the sizes that the thesis varies)."""

    patch_size: int = 32
    """Points of a patch: 16 or 32 in the thesis; it divides `CLOUD_POINTS`."""
    layers: int = 2
    """Transformer layers: 2 or 3 in the thesis."""
    heads: int = 4
    """Heads of the self-attention."""
    dropout: float = 0.01
    """While it is trained."""

    @property
    def patches(self) -> int:
        """Number of patches."""
        return CLOUD_POINTS // self.patch_size


@dataclass(frozen=True, kw_only=True)
class KeypointConfig:
    """A `KeypointNetwork` or `BehaviorCloningNetwork` on the tokens of an encoder."""

    encoder: EncoderConfig = field(default_factory=EncoderConfig)
    use_com: bool = True
    """Whether the true COM is an input."""
    heads: int = 8
    """Heads of the cross-attention: 8 or 16 in the thesis."""
    dropout: float = 0.1
    """While it is trained."""

    @property
    def query_size(self) -> int:
        """Numbers that the query is made from: the goal's 2, and the COM's 3."""
        return 5 if self.use_com else 2


@dataclass(frozen=True, kw_only=True)
class SurfaceConfig:
    """A `SurfaceKeypointNetwork`."""

    patches: int = 16
    """Patches of a cloud, which overlap."""
    patch_size: int = 32
    """Points of a patch."""
    width: int = 128
    """Features of a token."""
    patch_width: int = 256
    """Hidden features of a patch's network."""
    layers: int = 2
    """Layers of the encoder."""
    heads: int = 4
    """Heads of the self-attention."""
    query_heads: int = 8
    """Heads of the cross-attention."""
    point_width: int = 64
    """Hidden features of the network that looks at single points."""
    use_com: bool = False
    """Whether the true COM is an input, and the origin of frame G; else the cloud's mean is."""
    use_hand: bool = True
    """Whether the hand state is an input."""
