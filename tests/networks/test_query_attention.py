"""QueryAttention is nn.MultiheadAttention, cheaper."""

import pytest
import torch
from torch import nn

from keypush.networks.query_attention import QueryAttention


@pytest.mark.parametrize("heads", [8, 16])
def test_it_is_multi_head_attention_with_one_query(heads: int) -> None:
    torch.manual_seed(0)
    reference = nn.MultiheadAttention(128, heads, batch_first=True)
    nn.init.normal_(reference.in_proj_bias)
    attention = QueryAttention(128, heads)
    attention.load_state_dict(reference.state_dict())
    query = torch.randn(5, 128, requires_grad=True)
    tokens = torch.randn(5, 17, 128, requires_grad=True)
    expected, _ = reference(query[:, None], tokens, tokens, need_weights=False)
    found = attention(query, tokens)
    torch.testing.assert_close(found, expected[:, 0])
    direction = torch.randn(5, 128)
    wanted = torch.autograd.grad((expected[:, 0] * direction).sum(), [query, tokens])
    given = torch.autograd.grad((found * direction).sum(), [query, tokens])
    for mine, theirs in zip(given, wanted, strict=True):
        torch.testing.assert_close(mine, theirs, atol=1e-5, rtol=1e-4)
