"""Attention among tokens, and of one query to tokens."""

from collections.abc import Callable

import numpy as np

from keypush.learning.inference.ops import Affine, Array, float32, normed, softmax


class EncoderLayer:
    """A pre-LN layer: attention among tokens, then a feed-forward part; tokens have zero mean."""

    def __init__(
        self,
        in_proj: Affine,
        out_proj: Affine,
        feed: tuple[Affine, Affine],
        heads: int,
        activation: Callable[[Array], Array],
    ) -> None:
        """Args: layers with the norms folded in; `in_proj` gives queries, keys and values."""
        width = out_proj.weight.shape[1]
        scale = np.ones(3 * width)
        scale[:width] = (width // heads) ** -0.5
        self._in_proj = Affine(in_proj.weight * scale, in_proj.bias * scale).ready()
        self._out_proj = out_proj.centred().ready()
        self._feed = feed[0].ready(), feed[1].centred().ready()
        self._split = (3, heads, width // heads)
        self._activation = activation

    def __call__(self, tokens: Array) -> Array:
        """Maps tokens (T, width) to tokens of the same shape; overwrites them."""
        count, width = tokens.shape
        qkv = self._in_proj(normed(tokens)).reshape(count, *self._split)
        q, k, v = qkv[:, 0].swapaxes(0, 1), qkv[:, 1].transpose(1, 2, 0), qkv[:, 2].swapaxes(0, 1)
        mixed = softmax(q @ k) @ v
        tokens += self._out_proj(mixed.swapaxes(0, 1).reshape(count, width))
        tokens += self._feed[1](self._activation(self._feed[0](normed(tokens))))
        return tokens


class QueryAttention:
    """One query attends to all tokens.

    Keys need not be made: q (W_k t + b_k) = (W_k' q) t + q b_k, whose last term is the same for all
    tokens and cancels in the softmax; and the values' projection goes behind the weighted sum.
    """

    def __init__(self, query: Affine, key: Affine, value: Affine, heads: int) -> None:
        """Args: the projections (width to width), norms folded in."""
        width = key.weight.shape[0]
        size = width // heads
        self._query = query.ready()
        self._key = float32(key.weight.T.reshape(heads, size, width) * size**-0.5)
        self._value = float32(value.weight.reshape(width, heads, size).swapaxes(0, 1))
        self._bias = float32(value.bias)
        self._heads = heads

    def __call__(self, query: Array, tokens: Array) -> Array:
        """Maps query (width,) and tokens (T, width) to (width,), before the output projection."""
        q = self._query(query).reshape(self._heads, 1, -1)
        absorbed: Array = (q @ self._key)[:, 0]
        scores: Array = absorbed @ tokens.T
        mixed: Array = softmax(scores) @ tokens
        values: Array = mixed[:, None] @ self._value
        return values.reshape(-1) + self._bias
