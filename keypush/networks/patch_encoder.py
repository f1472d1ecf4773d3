"""PatchTransformerEncoder: a cloud and the hand's state become tokens.

CORN's encoder (Cho et al., ICLR 2024; its models/cloud/point_mae.py and models/rl/net/icp.py),
with the same parameters: patches of neighbouring points, sorted by distance from their centre,
through an MLP; the centre's position added; the hand as one more token in front; pre-LN layers.
"""

import torch
from torch import nn
from torch.nn import functional

from keypush.networks.config import HAND_SIZE, WIDTH, EncoderConfig

_PATCH_WIDTH = 256


class EncoderLayer(nn.Module):
    """A pre-LN self-attention layer with a feed-forward part of ratio 1."""

    def __init__(self, config: EncoderConfig) -> None:
        super().__init__()
        self.heads = config.heads
        self.dropout = config.dropout
        self.norm1 = nn.LayerNorm(WIDTH)
        self.in_proj = nn.Linear(WIDTH, 3 * WIDTH)
        self.out_proj = nn.Linear(WIDTH, WIDTH)
        self.dense = nn.Linear(WIDTH, WIDTH)
        self.norm2 = nn.LayerNorm(WIDTH)
        self.feed = nn.Sequential(nn.Linear(WIDTH, WIDTH), nn.GELU(), nn.Linear(WIDTH, WIDTH))

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """Maps tokens (B, T, WIDTH) to tokens of the same shape."""
        mixed = self._drop(self.dense(self.out_proj(self._attend(self.norm1(tokens)))))
        tokens = tokens + mixed
        mapped: torch.Tensor = tokens + self._drop(self.feed(self.norm2(tokens)))
        return mapped

    def _attend(self, tokens: torch.Tensor) -> torch.Tensor:
        batch, count, _ = tokens.shape
        qkv = self.in_proj(tokens).view(batch, count, 3, self.heads, WIDTH // self.heads)
        q, k, v = qkv.permute(2, 0, 3, 1, 4).unbind(0)
        # Written out: in bf16 on CPUs the fused kernel's backward pass is several times slower.
        weights = torch.softmax(q @ k.transpose(-2, -1) * (WIDTH // self.heads) ** -0.5, dim=-1)
        mixed: torch.Tensor = (weights @ v).transpose(1, 2).reshape(batch, count, WIDTH)
        return mixed

    def _drop(self, tokens: torch.Tensor) -> torch.Tensor:
        return functional.dropout(tokens, self.dropout, self.training)


class PatchTransformerEncoder(nn.Module):
    """Maps clouds and hand states to tokens of the hand and of the patches."""

    def __init__(self, config: EncoderConfig) -> None:
        super().__init__()
        self.config = config
        self.patch = nn.Sequential(
            nn.Linear(3 * config.patch_size, _PATCH_WIDTH), nn.LayerNorm(_PATCH_WIDTH), nn.GELU(),
            nn.Linear(_PATCH_WIDTH, _PATCH_WIDTH), nn.LayerNorm(_PATCH_WIDTH), nn.GELU(),
            nn.Linear(_PATCH_WIDTH, WIDTH),
        )  # fmt: skip
        self.position = nn.Sequential(nn.Linear(3, WIDTH), nn.GELU(), nn.Linear(WIDTH, WIDTH - 3))
        self.hand = nn.Linear(HAND_SIZE, WIDTH)
        self.layers = nn.ModuleList(EncoderLayer(config) for _ in range(config.layers))
        self.norm = nn.LayerNorm(WIDTH, eps=1e-6)

    def forward(
        self,
        cloud: torch.Tensor,
        centres: torch.Tensor,
        members: torch.Tensor,
        hand: torch.Tensor,
    ) -> torch.Tensor:
        """Encodes scenes whose positions are normalised (`normalisation`).

        Args:
            cloud: (B, N, 3).
            centres: indices of patch centres, (B, patches).
            members: indices of patch points, nearest first, (B, patches, patch_size).
            hand: (B, 9).

        Returns:
            Tokens (B, 1 + patches, WIDTH), the hand's first.
        """
        batch, patches, size = members.shape
        rows = torch.arange(batch, device=cloud.device)
        p_centres = cloud[rows[:, None], centres]
        points = cloud[rows[:, None, None], members] - p_centres[:, :, None]
        positions = torch.cat([self.position(p_centres), p_centres], dim=-1)
        tokens = self.patch(points.reshape(batch, patches, 3 * size)) + positions
        tokens = torch.cat([self.hand(hand)[:, None], tokens], dim=1)
        for layer in self.layers:
            tokens = layer(tokens)
        normed: torch.Tensor = self.norm(tokens)
        return normed
