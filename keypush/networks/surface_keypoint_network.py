"""SurfaceKeypointNetwork: a patch transformer that selects surface points.

Encoder as in CORN (Cho et al., ICLR 2024): patch tokens of a cloud and one token of the hand state.
A query token made from goal (and COM) attends to them; its answer conditions a small network that
gives every point of the cloud a score. The keypoint is the softmax-weighted mean of the points, so
it stays on the surface for shapes that were not trained on. Every input is in the goal frame G.
"""

from dataclasses import dataclass

import torch
from torch import nn
from torch.nn import functional

from keypush.networks.config import HAND_SIZE, SurfaceConfig

OCTAVES = (2.0, 4.0, 8.0)
"""Angular frequencies of the Fourier features of a point, rad per unit of length in G."""
POINT_FEATURES = 3 + 6 * len(OCTAVES)


@dataclass(frozen=True)
class NetworkInput:
    """A batch of B scenes in frame G, lengths in units of `goal_frame.LENGTH`.

    Attributes:
        cloud: (B, N, 3).
        centres: indices of patch centres, (B, patches).
        members: indices of patch points, nearest first, (B, patches, patch_size).
        goal: (B, 2).
        com: (B, 3); read when the network uses it.
        hand: position and first two axes of the tool, (B, 9); read when the network uses it.
    """

    cloud: torch.Tensor
    centres: torch.Tensor
    members: torch.Tensor
    goal: torch.Tensor
    com: torch.Tensor
    hand: torch.Tensor


def _gelu() -> nn.GELU:
    # The tanh form: NumPy evaluates it fast, and `learning/inference/` runs these weights in it.
    return nn.GELU(approximate="tanh")


class EncoderLayer(nn.Module):
    """A pre-LN self-attention layer with a feed-forward part of ratio 1."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm1 = nn.LayerNorm(width)
        self.in_proj = nn.Linear(width, 3 * width)
        self.out_proj = nn.Linear(width, width)
        self.norm2 = nn.LayerNorm(width)
        self.feed = nn.Sequential(nn.Linear(width, width), _gelu(), nn.Linear(width, width))

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """Maps tokens (B, T, width) to tokens of the same shape."""
        batch, count, width = tokens.shape
        qkv = self.in_proj(self.norm1(tokens))
        qkv = qkv.view(batch, count, 3, self.heads, width // self.heads).permute(2, 0, 3, 1, 4)
        mixed = functional.scaled_dot_product_attention(qkv[0], qkv[1], qkv[2])
        tokens = tokens + self.out_proj(mixed.transpose(1, 2).reshape(batch, count, width))
        mapped: torch.Tensor = tokens + self.feed(self.norm2(tokens))
        return mapped


class CrossAttention(nn.Module):
    """One query token attends to all tokens."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.query = nn.Linear(width, width)
        self.key_value = nn.Linear(width, 2 * width)
        self.out_proj = nn.Linear(width, width)

    def forward(self, query: torch.Tensor, tokens: torch.Tensor) -> torch.Tensor:
        """Maps query (B, width) and tokens (B, T, width) to (B, width)."""
        batch, count, width = tokens.shape
        q = self.query(query).view(batch, self.heads, 1, -1)
        kv = self.key_value(tokens).view(batch, count, 2, self.heads, width // self.heads)
        kv = kv.permute(2, 0, 3, 1, 4)
        mixed = functional.scaled_dot_product_attention(q, kv[0], kv[1])
        answer: torch.Tensor = self.out_proj(mixed.reshape(batch, width))
        return answer


def point_features(cloud: torch.Tensor) -> torch.Tensor:
    """Coordinates and their Fourier features: (..., 3) -> (..., POINT_FEATURES)."""
    waves = [wave(octave * cloud) for octave in OCTAVES for wave in (torch.sin, torch.cos)]
    return torch.cat([cloud, *waves], dim=-1)


class SurfaceKeypointNetwork(nn.Module):
    """Maps a `NetworkInput` to keypoints p_GK."""

    def __init__(self, config: SurfaceConfig) -> None:
        super().__init__()
        self.config = config
        width, hidden = config.width, config.patch_width
        self.patch = nn.Sequential(
            nn.Linear(3 * config.patch_size, hidden), nn.LayerNorm(hidden), _gelu(),
            nn.Linear(hidden, hidden), nn.LayerNorm(hidden), _gelu(),
            nn.Linear(hidden, width),
        )  # fmt: skip
        self.position = nn.Sequential(nn.Linear(3, width), _gelu(), nn.Linear(width, width))
        self.hand = nn.Linear(HAND_SIZE, width) if config.use_hand else None
        self.layers = nn.ModuleList(EncoderLayer(width, config.heads) for _ in range(config.layers))
        self.norm = nn.LayerNorm(width)
        query_size = 5 if config.use_com else 2
        self.query = nn.Sequential(
            nn.Linear(query_size, width), _gelu(), nn.Linear(width, width), _gelu(),
            nn.Linear(width, width),
        )  # fmt: skip
        self.attention = CrossAttention(width, config.query_heads)
        self.context = nn.Linear(width, config.point_width)
        self.point = nn.Linear(POINT_FEATURES, config.point_width, bias=False)
        self.point_hidden = nn.Linear(config.point_width, config.point_width)
        self.score = nn.Linear(config.point_width, 1, bias=False)
        self.score_scale = nn.Parameter(torch.tensor(4.0))

    def tokens(self, scene: NetworkInput) -> torch.Tensor:
        """Encodes hand and patches: (B, patches (+ 1), width), the hand's token first."""
        batch, patches, size = scene.members.shape
        rows = torch.arange(batch)
        centres = scene.cloud[rows[:, None], scene.centres]
        members = scene.cloud[rows[:, None, None], scene.members] - centres[:, :, None]
        tokens = self.patch(members.reshape(batch, patches, 3 * size)) + self.position(centres)
        if self.hand is not None:
            tokens = torch.cat([self.hand(scene.hand)[:, None], tokens], dim=1)
        for layer in self.layers:
            tokens = layer(tokens)
        normed: torch.Tensor = self.norm(tokens)
        return normed

    def forward(self, scene: NetworkInput) -> torch.Tensor:
        """Predicts the keypoints p_GK, shape (B, 3), in units of `goal_frame.LENGTH`."""
        query = torch.cat([scene.goal, scene.com], 1) if self.config.use_com else scene.goal
        query = self.query(query)
        context = self.context(query + self.attention(query, self.tokens(scene)))
        hidden = functional.relu(self.point(point_features(scene.cloud)) + context[:, None])
        scores = self.score(functional.relu(self.point_hidden(hidden)))[..., 0]
        weights = torch.softmax(self.score_scale * scores, dim=1)
        return torch.bmm(weights[:, None], scene.cloud)[:, 0]
