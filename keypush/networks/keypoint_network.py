"""KeypointNetwork and BehaviorCloningNetwork: the thesis' heads on frozen encoder tokens.

Thesis, section 4.2 and table 5.2: a query made from the goal (and the COM) attends to the tokens;
what it finds, with goal (and COM) beside it once more, goes through an MLP.
"""

import torch
from torch import nn

from keypush.networks.config import WIDTH, KeypointConfig
from keypush.networks.patch_encoder import PatchTransformerEncoder
from keypush.networks.query_attention import QueryAttention


class QueryHead(nn.Module):
    """From tokens and a query to numbers."""

    def __init__(self, config: KeypointConfig, outputs: int) -> None:
        super().__init__()
        size = config.query_size
        self.query = nn.Sequential(
            nn.Linear(size, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH), nn.ReLU(),
            nn.Linear(WIDTH, WIDTH),
        )  # fmt: skip
        self.attention = QueryAttention(WIDTH, config.heads)
        self.output = nn.Sequential(
            nn.Linear(WIDTH + size, 128), nn.LayerNorm(128), nn.ReLU(), nn.Dropout(config.dropout),
            nn.Linear(128, 64), nn.LayerNorm(64), nn.ReLU(), nn.Dropout(config.dropout),
            nn.Linear(64, outputs),
        )  # fmt: skip

    def forward(self, tokens: torch.Tensor, query: torch.Tensor) -> torch.Tensor:
        """Maps tokens (B, T, WIDTH) and goal (and COM), (B, 2 or 5), to (B, outputs)."""
        answer = self.attention(self.query(query), tokens)
        outputs: torch.Tensor = self.output(torch.cat([answer, query], dim=1))
        return outputs


class _EncodedNetwork(nn.Module):
    """A frozen encoder and a head."""

    OUTPUTS: int

    def __init__(self, config: KeypointConfig) -> None:
        super().__init__()
        self.config = config
        self.encoder = PatchTransformerEncoder(config.encoder).requires_grad_(False)
        self.head = QueryHead(config, self.OUTPUTS)

    def train(self, mode: bool = True) -> "_EncodedNetwork":
        """Sets the head's mode; the encoder stays in evaluation mode."""
        super().train(mode)
        self.encoder.eval()
        return self

    def forward(
        self,
        cloud: torch.Tensor,
        centres: torch.Tensor,
        members: torch.Tensor,
        hand: torch.Tensor,
        query: torch.Tensor,
    ) -> torch.Tensor:
        """Returns (B, OUTPUTS).

        Args:
            cloud: (B, N, 3), as centres, members and hand: see `PatchTransformerEncoder`.
            centres: (B, patches).
            members: (B, patches, patch_size).
            hand: (B, 9).
            query: normalised goal xy and, if the network uses it, COM, (B, 2 or 5).
        """
        with torch.no_grad():
            tokens = self.encoder(cloud, centres, members, hand)
        outputs: torch.Tensor = self.head(tokens, query)
        return outputs


class KeypointNetwork(_EncodedNetwork):
    """Predicts the normalised keypoint p_WK, (B, 3)."""

    OUTPUTS = 3


class BehaviorCloningNetwork(_EncodedNetwork):
    """Predicts the tool action in shares of its clips, (B, 6): the thesis' baseline."""

    OUTPUTS = 6
