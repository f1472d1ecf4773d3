"""QueryAttention: one query token attends to many tokens, at the price of one token.

The same function of the same parameters as `nn.MultiheadAttention` with a query of length one (a
test compares them). With one query, keys need not be made: q (W_k t + b_k) = (W_k' q) t + q b_k,
whose last term is the same for all tokens and cancels in the softmax; and the values' projection
goes behind the weighted sum.
"""

import torch
from torch import nn
from torch.nn import functional


class QueryAttention(nn.Module):
    """Multi-head attention of one query per scene."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        reference = nn.MultiheadAttention(width, heads, batch_first=True)
        self.in_proj_weight = reference.in_proj_weight
        self.in_proj_bias = reference.in_proj_bias
        self.out_proj = nn.Linear(width, width)
        nn.init.zeros_(self.out_proj.bias)  # as nn.MultiheadAttention does

    def forward(self, query: torch.Tensor, tokens: torch.Tensor) -> torch.Tensor:
        """Maps query (B, width) and tokens (B, T, width) to (B, width)."""
        batch, width = query.shape
        size = width // self.heads
        w_q, w_k, w_v = self.in_proj_weight.chunk(3)
        b_q, _, b_v = self.in_proj_bias.chunk(3)
        q = functional.linear(query, w_q, b_q).view(batch, self.heads, size)
        absorbed = torch.einsum("bhs,hsw->bhw", q, w_k.view(self.heads, size, width))
        scores = absorbed @ tokens.transpose(1, 2) * size**-0.5
        mixed = torch.softmax(scores, dim=-1) @ tokens
        values = torch.einsum("bhw,hsw->bhs", mixed, w_v.view(self.heads, size, width))
        answer: torch.Tensor = self.out_proj(values.reshape(batch, width) + b_v)
        return answer
