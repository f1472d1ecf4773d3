"""Our network, which selects points of the cloud: `networks.surface_keypoint_network`."""

import numpy as np

from keypush.learning.inference.attention import EncoderLayer, QueryAttention
from keypush.learning.inference.ops import (
    Affine,
    Array,
    Index,
    NormedLayer,
    float32,
    gelu_tanh,
    linear,
    norm_gain,
    normed,
    relu,
    softmax,
)
from keypush.learning.tensors import Tensors
from keypush.networks.config import HAND_SIZE, SurfaceConfig

_OCTAVES = (2.0, 4.0, 8.0)
"""As in the network: each is twice the one before it."""
_POINT_FEATURES = 3 + 6 * len(_OCTAVES)


class SurfaceNetwork:
    """A `SurfaceKeypointNetwork`."""

    def __init__(self, tensors: Tensors, config: SurfaceConfig) -> None:
        """Args: takes its weights from `tensors`, but does not say that it has all of them."""
        self.config = config
        width, patch_width, point_width = config.width, config.patch_width, config.point_width

        def take(name: str, inputs: int, outputs: int) -> Affine:
            return linear(tensors, name, inputs, outputs)

        first = take("patch.0", 3 * config.patch_size, patch_width)
        second = take("patch.3", patch_width, patch_width)
        self._patch = [
            NormedLayer(layer, norm_gain(tensors, f"patch.{i}", patch_width), gelu_tanh)
            for i, layer in ((1, first), (4, second))
        ]
        self._position = take("position.0", 3, width).ready()
        patch, position = take("patch.6", patch_width, width), take("position.2", width, width)
        weight = np.concatenate([patch.weight, position.weight])
        self._write = Affine(weight, patch.bias + position.bias).centred().ready()
        hand = take("hand", HAND_SIZE, width).centred().ready() if config.use_hand else None
        self._hand = hand
        self._layers = [_layer(tensors, f"layers.{i}.", config) for i in range(config.layers)]
        norm = norm_gain(tensors, "norm", width)
        sizes = [5 if config.use_com else 2, width, width, width]
        self._query = [take(f"query.{2 * i}", sizes[i], sizes[i + 1]).ready() for i in range(3)]
        key_value = take("attention.key_value", width, 2 * width).after_norm(norm)
        key, value = (
            Affine(key_value.weight[:, part], key_value.bias[part])
            for part in (slice(width), slice(width, None))
        )
        query = take("attention.query", width, width)
        self._attention = QueryAttention(query, key, value, config.query_heads)
        # The context of query + out_proj(answer), as a layer of the two side by side.
        context = take("context", width, point_width)
        answer = take("attention.out_proj", width, width).then(context)
        both = np.concatenate([context.weight, answer.weight])
        self._context = Affine(both, answer.bias).ready()
        self._point = float32(tensors.take("point.weight", point_width, _POINT_FEATURES))
        hidden = take("point_hidden", point_width, point_width)
        self._point_hidden = float32(hidden.weight.T)
        self._point_bias = float32(hidden.bias[:, None])
        score = tensors.take("score.weight", 1, point_width)[0]
        self._score = float32(score * tensors.take("score_scale"))

    def __call__(
        self, cloud: Array, centres: Index, members: Index, query: Array, hand: Array
    ) -> Array:
        """Predicts p_GK (3,) from cloud (N, 3), patches, goal (2 or with COM 5,) and hand (9,)."""
        tokens = self._tokens(cloud, centres, members, hand)
        token = query
        for layer in self._query[:2]:
            token = gelu_tanh(layer(token))
        token = self._query[2](token)
        answer = self._attention(token, tokens)
        return self._select(cloud, self._context(np.concatenate([token, answer])))

    def _tokens(self, cloud: Array, centres: Index, members: Index, hand: Array) -> Array:
        p_centres = cloud[centres]
        x = (cloud[members] - p_centres[:, None]).reshape(len(centres), -1)
        for layer in self._patch:
            x = layer(x)
        x = self._write(np.concatenate([x, gelu_tanh(self._position(p_centres))], axis=1))
        if self._hand is not None:
            x = np.concatenate([self._hand(hand)[None], x])
        for transform in self._layers:
            x = transform(x)
        return normed(x)

    def _select(self, cloud: Array, context: Array) -> Array:
        # Points are columns here; the context enters as the weight of a row of ones.
        weight = np.concatenate([self._point, context[:, None]], axis=1)
        x = relu(weight @ features(np.ascontiguousarray(cloud.T)))
        x = self._point_hidden @ x
        x += self._point_bias
        keypoint: Array = softmax(self._score @ relu(x)) @ cloud
        return keypoint


def _layer(tensors: Tensors, at: str, config: SurfaceConfig) -> EncoderLayer:
    width = config.width
    in_proj = linear(tensors, at + "in_proj", width, 3 * width)
    feed = linear(tensors, at + "feed.0", width, width)
    return EncoderLayer(
        in_proj.after_norm(norm_gain(tensors, at + "norm1", width)),
        linear(tensors, at + "out_proj", width, width),
        (
            feed.after_norm(norm_gain(tensors, at + "norm2", width)),
            linear(tensors, at + "feed.2", width, width),
        ),
        config.heads,
        gelu_tanh,
    )


def features(points: Array) -> Array:
    """`point_features` of columns (3, N), and a row of ones: (_POINT_FEATURES + 1, N).

    Uses the double-angle formulas, as the octaves double.
    """
    out = np.empty((_POINT_FEATURES + 1, points.shape[1]), dtype=np.float32)
    out[:3] = points
    sine, cosine = out[3:6], out[6:9]
    np.multiply(points, np.float32(_OCTAVES[0]), out=cosine)
    np.sin(cosine, out=sine)
    np.cos(cosine, out=cosine)
    for i in range(1, len(_OCTAVES)):
        finer = out[3 + 6 * i : 9 + 6 * i]
        np.multiply(sine, cosine, out=finer[:3])
        finer[:3] *= 2
        np.multiply(sine, sine, out=finer[3:])
        finer[3:] *= -2
        finer[3:] += 1
        sine, cosine = finer[:3], finer[3:]
    out[-1] = 1.0
    return out
