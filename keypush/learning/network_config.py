"""The sizes of the keypoint network, apart from it: reading a configuration needs no torch."""

from dataclasses import dataclass


@dataclass(kw_only=True)
class NetworkConfig:
    """Sizes of the network; stored beside its weights."""

    patches: int = 16
    patch_size: int = 32
    width: int = 128
    patch_width: int = 256
    layers: int = 2
    heads: int = 4
    query_heads: int = 8
    point_width: int = 64
    use_com: bool = False
    """Whether the true COM is an input, and the origin of frame G; else the cloud's mean is."""
    use_hand: bool = True
    """Whether the hand state is an input."""
