"""The thesis' networks: `networks.keypoint_network` on `networks.patch_encoder`."""

import numpy as np

from keypush.learning.inference.attention import EncoderLayer, QueryAttention
from keypush.learning.inference.ops import (
    Affine,
    Array,
    Exact,
    Index,
    NormedLayer,
    gelu,
    linear,
    norm_gain,
    normed,
    relu,
)
from keypush.learning.tensors import Tensors
from keypush.networks.config import HAND_SIZE, WIDTH, EncoderConfig, KeypointConfig

_PATCH_WIDTH = 256
_FINAL_EPSILON = 1e-6


class PatchEncoder:
    """A `PatchTransformerEncoder`, but for the gain and bias of its last norm."""

    def __init__(self, tensors: Tensors, prefix: str, config: EncoderConfig) -> None:
        def take(name: str, inputs: int, outputs: int) -> Affine:
            return linear(tensors, prefix + name, inputs, outputs)

        def gain(name: str, width: int) -> tuple[Exact, Exact]:
            return norm_gain(tensors, prefix + name, width)

        first = take("patch.0", 3 * config.patch_size, _PATCH_WIDTH)
        second = take("patch.3", _PATCH_WIDTH, _PATCH_WIDTH)
        self._patch = [
            NormedLayer(layer, gain(f"patch.{i}", _PATCH_WIDTH), gelu)
            for i, layer in ((1, first), (4, second))
        ]
        self._position = take("position.0", 3, WIDTH).ready()
        self._write = _writer(take("patch.6", _PATCH_WIDTH, WIDTH),
                              take("position.2", WIDTH, WIDTH - 3)).centred().ready()  # fmt: skip
        self._hand = take("hand", HAND_SIZE, WIDTH).centred().ready()
        self._layers = []
        for i in range(config.layers):
            at = f"layers.{i}."
            out_proj = take(at + "out_proj", WIDTH, WIDTH).then(take(at + "dense", WIDTH, WIDTH))
            in_proj = take(at + "in_proj", WIDTH, 3 * WIDTH).after_norm(gain(at + "norm1", WIDTH))
            feed = take(at + "feed.0", WIDTH, WIDTH).after_norm(gain(at + "norm2", WIDTH))
            feeds = feed, take(at + "feed.2", WIDTH, WIDTH)
            self._layers.append(EncoderLayer(in_proj, out_proj, feeds, config.heads, gelu))

    def __call__(self, cloud: Array, centres: Index, members: Index, hand: Array) -> Array:
        """Encodes a scene whose positions are normalised.

        Args:
            cloud: (N, 3).
            centres: indices of patch centres, (patches,).
            members: indices of patch points, nearest first, (patches, patch_size).
            hand: (9,).

        Returns:
            Tokens (1 + patches, WIDTH), the hand's first, whose last norm has no gain and bias yet.
        """
        p_centres = cloud[centres]
        x = (cloud[members] - p_centres[:, None]).reshape(len(centres), -1)
        for layer in self._patch:
            x = layer(x)
        tokens = np.empty((1 + len(centres), WIDTH), dtype=np.float32)
        tokens[0] = self._hand(hand)
        tokens[1:] = self._write(
            np.concatenate([x, gelu(self._position(p_centres)), p_centres], axis=1)
        )
        for transform in self._layers:
            tokens = transform(tokens)
        return normed(tokens, _FINAL_EPSILON)


def _writer(patch: Affine, position: Affine) -> Affine:
    """One layer for what writes to tokens: from patch and position, and the centre itself."""
    weight = np.zeros((len(patch.weight) + len(position.weight) + 3, WIDTH))
    weight[: len(patch.weight)] = patch.weight
    weight[len(patch.weight) : -3, :-3] = position.weight
    weight[-3:, -3:] = np.eye(3)
    return Affine(weight, patch.bias + np.append(position.bias, np.zeros(3)))


class ThesisNetwork:
    """A `KeypointNetwork` or a `BehaviorCloningNetwork`."""

    def __init__(self, tensors: Tensors, config: KeypointConfig, outputs: int) -> None:
        """Args: takes its weights from `tensors`, but does not say that it has all of them."""
        self.config = config
        self._encoder = PatchEncoder(tensors, "encoder.", config.encoder)
        norm = norm_gain(tensors, "encoder.norm", WIDTH)

        def take(name: str, inputs: int, outputs: int) -> Affine:
            return linear(tensors, f"head.{name}", inputs, outputs)

        size = config.query_size
        first, second = take("query.0", size, WIDTH), take("query.2", WIDTH, WIDTH)
        self._query = first.ready(), second.ready()
        weight = tensors.take("head.attention.in_proj_weight", 3 * WIDTH, WIDTH)
        bias = tensors.take("head.attention.in_proj_bias", 3 * WIDTH)
        query, key, value = (
            Affine(w.T, b) for w, b in zip(np.split(weight, 3), np.split(bias, 3), strict=True)
        )
        self._attention = QueryAttention(
            take("query.4", WIDTH, WIDTH).then(query),
            key.after_norm(norm),
            value.after_norm(norm),
            config.heads,
        )
        out_proj = take("attention.out_proj", WIDTH, WIDTH)
        hidden = _behind(out_proj, take("output.0", WIDTH + size, 128)), take("output.4", 128, 64)
        self._hidden = [
            NormedLayer(layer, norm_gain(tensors, f"head.output.{i}", len(layer.bias)), relu)
            for i, layer in zip((1, 5), hidden, strict=True)
        ]
        self._output = take("output.8", 64, outputs).ready()

    def __call__(
        self, cloud: Array, centres: Index, members: Index, query: Array, hand: Array
    ) -> Array:
        """Returns (outputs,); the query is the normalised goal xy and, if used, the COM."""
        tokens = self._encoder(cloud, centres, members, hand)
        first, second = self._query
        answer = self._attention(relu(second(relu(first(query)))), tokens)
        x = np.concatenate([answer, query])[None]
        for layer in self._hidden:
            x = layer(x)
        return self._output(x[0])


def _behind(projection: Affine, layer: Affine) -> Affine:
    """A layer whose first inputs come through a projection; the others as they are."""
    inputs = projection.then(Affine(layer.weight[:WIDTH], layer.bias))
    return Affine(np.concatenate([inputs.weight, layer.weight[WIDTH:]]), inputs.bias)
