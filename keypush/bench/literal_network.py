"""The thesis' head as one would write it down: `nn.MultiheadAttention`, and no shortcut."""

from copy import deepcopy

import torch
from torch import nn

from keypush.networks.config import WIDTH
from keypush.networks.keypoint_network import QueryHead


class LiteralHead(nn.Module):
    """The same function as a `QueryHead`, with the same weights."""

    def __init__(self, head: QueryHead) -> None:
        super().__init__()
        self.query = deepcopy(head.query)
        self.output = deepcopy(head.output)
        self.attention = nn.MultiheadAttention(WIDTH, head.attention.heads, batch_first=True)
        self.attention.load_state_dict(head.attention.state_dict())

    def forward(self, tokens: torch.Tensor, query: torch.Tensor) -> torch.Tensor:
        """Maps tokens (B, T, WIDTH) and goal (and COM), (B, 2 or 5), to (B, outputs)."""
        asked = self.query(query)[:, None]
        answer, _ = self.attention(asked, tokens, tokens, need_weights=False)
        outputs: torch.Tensor = self.output(torch.cat([answer[:, 0], query], dim=1))
        return outputs
