"""The keypoint network's forward pass in NumPy, for one scene at a time.

At batch size one PyTorch spends most of its time between operations; this is faster, needs no
thread settings and gives the same keypoint to rounding (a test compares them).

Layer norms subtract the mean over features. Subtraction is linear, so it is folded into the weights
of every layer that writes to what is normed; likewise a norm's gain and bias into the layer behind.
"""

import numpy as np
from numpy.typing import NDArray
from torch import nn

from keypush.networks.surface_keypoint_network import (
    OCTAVES,
    POINT_FEATURES,
    SurfaceKeypointNetwork,
)

Array = NDArray[np.float32]
Index = NDArray[np.intp]
Affine = tuple[Array, Array]

_GELU_SCALE = np.float32(np.sqrt(2.0 / np.pi))
_GELU_CUBIC = np.float32(_GELU_SCALE * 0.044715)
_ONE = np.float32(1.0)
_HALF = np.float32(0.5)
_EPSILON = np.float32(1e-5)


def _array(tensor: object) -> Array:
    array: Array = tensor.detach().numpy()  # type: ignore[attr-defined]  # parameter or tensor
    return np.ascontiguousarray(array)


def _affine(linear: object, norm: object = None, *, centred: bool = False) -> Affine:
    """Weights (in, out) and bias (out,) of a linear layer, behind `norm` if given.

    `centred` takes the mean over the outputs away.
    """
    assert isinstance(linear, nn.Linear)
    weight, bias = _array(linear.weight), _array(linear.bias)
    if isinstance(norm, nn.LayerNorm):
        bias = bias + weight @ _array(norm.bias)
        weight = weight * _array(norm.weight)
    if centred:
        weight, bias = weight - weight.mean(axis=0), bias - bias.mean()
    return np.ascontiguousarray(weight.T), bias


def _apply(x: Array, affine: Affine) -> Array:
    y = x @ affine[0]
    y += affine[1]
    return y


def _norm(x: Array) -> Array:
    """Divides rows of zero mean by their standard deviation."""
    variance = np.einsum("ij,ij->i", x, x)
    variance *= np.float32(1.0 / x.shape[1])
    variance += _EPSILON
    y: Array = x / np.sqrt(variance)[:, None]
    return y


def _gelu(x: Array) -> Array:
    """GELU in its tanh form; overwrites x."""
    y = x * x
    y *= _GELU_CUBIC
    y += _GELU_SCALE
    y *= x
    np.tanh(y, out=y)
    y += _ONE
    x *= _HALF
    x *= y
    return x


def _softmax(x: Array) -> Array:
    """Softmax over the last axis; overwrites x."""
    x -= x.max(axis=-1, keepdims=True)
    np.exp(x, out=x)
    x /= x.sum(axis=-1, keepdims=True)
    return x


def _attend(q: Array, k: Array, v: Array, heads: int) -> Array:
    """Multi-head attention of queries (Q, width) to keys and values (T, width)."""
    size = q.shape[1] // heads
    q, k, v = (a.reshape(len(a), heads, size).transpose(1, 0, 2) for a in (q, k, v))
    scores = q @ k.transpose(0, 2, 1)
    scores *= np.float32(size**-0.5)
    return (_softmax(scores) @ v).transpose(1, 0, 2).reshape(-1, heads * size)


class _Layer:
    """One `EncoderLayer`."""

    def __init__(self, layer: nn.Module, heads: int) -> None:
        self.heads = heads
        feed = layer.feed
        assert isinstance(feed, nn.Sequential)
        self.in_proj = _affine(layer.in_proj, layer.norm1)
        self.out_proj = _affine(layer.out_proj, centred=True)
        self.feed = [_affine(feed[0], layer.norm2), _affine(feed[2], centred=True)]

    def __call__(self, tokens: Array) -> Array:
        width = tokens.shape[1]
        qkv = _apply(_norm(tokens), self.in_proj)
        q, k, v = qkv[:, :width], qkv[:, width : 2 * width], qkv[:, 2 * width :]
        tokens = tokens + _apply(_attend(q, k, v, self.heads), self.out_proj)
        tokens += _apply(_gelu(_apply(_norm(tokens), self.feed[0])), self.feed[1])
        return tokens


class NumpyNetwork:
    """The weights of a `SurfaceKeypointNetwork`, ready for single scenes."""

    def __init__(self, network: SurfaceKeypointNetwork) -> None:
        self.config = network.config
        patch, attention = network.patch, network.attention
        self._patch = [_affine(patch[i], centred=True) for i in (0, 3, 6)]
        self._gains = [(_array(patch[i].weight), _array(patch[i].bias)) for i in (1, 4)]
        self._position = [_affine(network.position[0]), _affine(network.position[2], centred=True)]
        self._hand = None if network.hand is None else _affine(network.hand, centred=True)
        self._layers = [_Layer(layer, self.config.heads) for layer in network.layers]
        self._query = [_affine(network.query[i]) for i in (0, 2, 4)]
        self._attention = [
            _affine(attention.query),
            _affine(attention.key_value, network.norm),
            _affine(attention.out_proj),
        ]
        self._context = _affine(network.context)
        self._point = _array(network.point.weight)
        self._point_hidden = _array(network.point_hidden.weight)
        self._point_bias = _array(network.point_hidden.bias)[:, None]
        self._score = _array(network.score.weight)[0] * _array(network.score_scale)

    def __call__(
        self, cloud: Array, centres: Index, members: Index, query: Array, hand: Array
    ) -> Array:
        """Predicts p_GK (3,) from cloud (N, 3), patches, goal (2 or with COM 5,) and hand (9,)."""
        tokens = self._tokens(cloud, centres, members, hand)
        token = query[None]
        for affine in self._query[:2]:
            token = _gelu(_apply(token, affine))
        token = _apply(token, self._query[2])
        to_query, to_key_value, to_out = self._attention
        kv = _apply(_norm(tokens), to_key_value)
        width = self.config.width
        heads = self.config.query_heads
        answer = _attend(_apply(token, to_query), kv[:, :width], kv[:, width:], heads)
        return self._select(cloud, _apply(token + _apply(answer, to_out), self._context))

    def _tokens(self, cloud: Array, centres: Index, members: Index, hand: Array) -> Array:
        p_centres = cloud[centres]
        x = (cloud[members] - p_centres[:, None]).reshape(len(centres), -1)
        for affine, (gain, bias) in zip(self._patch[:2], self._gains, strict=True):
            x = _norm(_apply(x, affine))
            x *= gain
            x += bias
            x = _gelu(x)
        x = _apply(x, self._patch[2])
        x += _apply(_gelu(_apply(p_centres, self._position[0])), self._position[1])
        if self._hand is not None:
            x = np.concatenate([_apply(hand[None], self._hand), x])
        for layer in self._layers:
            x = layer(x)
        return x

    def _select(self, cloud: Array, context: Array) -> Array:
        # Points are columns here; the context enters as the weight of a row of ones.
        weight = np.concatenate([self._point, context.T], axis=1)
        x = weight @ features(np.ascontiguousarray(cloud.T))
        np.maximum(x, 0, out=x)
        x = self._point_hidden @ x
        x += self._point_bias
        np.maximum(x, 0, out=x)
        keypoint: Array = _softmax(self._score @ x) @ cloud
        return keypoint


def features(points: Array) -> Array:
    """`network.point_features` of columns (3, N), and a row of ones: (POINT_FEATURES + 1, N).

    Uses the double-angle formulas, as `OCTAVES` double.
    """
    out = np.empty((POINT_FEATURES + 1, points.shape[1]), dtype=np.float32)
    out[:3] = points
    sine, cosine = out[3:6], out[6:9]
    np.multiply(points, np.float32(OCTAVES[0]), out=cosine)
    np.sin(cosine, out=sine)
    np.cos(cosine, out=cosine)
    for i in range(1, len(OCTAVES)):
        finer = out[3 + 6 * i : 9 + 6 * i]
        np.multiply(sine, cosine, out=finer[:3])
        finer[:3] *= 2
        np.multiply(sine, sine, out=finer[3:])
        finer[3:] *= -2
        finer[3:] += 1
        sine, cosine = finer[:3], finer[3:]
    out[-1] = 1.0
    return out
