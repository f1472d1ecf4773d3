"""What networks are made of, on float32 arrays of one scene.

Layers are prepared in float64 and run in float32. Layer norms subtract the mean over features.
Subtraction is linear, so it is folded into the weights of every layer that writes to what is
normed; likewise a norm's gain and bias into the layer behind, and neighbouring layers into one.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from keypush.learning.tensors import Tensors

Array = NDArray[np.float32]
Index = NDArray[np.intp]
Exact = NDArray[np.float64]

LAYER_NORM_EPSILON = 1e-5
"""PyTorch's default."""
_TANH_SCALE = float(np.sqrt(2.0 / np.pi))
_TANH_CUBIC = 0.044715 * _TANH_SCALE
_ERF_TERMS = (0.7978275, 0.03646991, -1.254795e-4, -3.046675e-5, 1.112611e-6)
"""erf(x / sqrt 2) = tanh(x (c0 + c1 x^2 + ...)): with these, GELU is right to 3.1e-6."""
_ERF_END = 20.25
"""x^2 up to which the terms were fitted; beyond, the tanh is 1."""


class Affine(NamedTuple):
    """x @ weight + bias."""

    weight: Exact
    """(inputs, outputs)."""
    bias: Exact
    """(outputs,)."""

    def after_norm(self, norm: tuple[Exact, Exact]) -> "Affine":
        """Takes over the gain and bias of a norm in front."""
        gain, bias = norm
        return Affine(self.weight * gain[:, None], self.bias + bias @ self.weight)

    def then(self, other: "Affine") -> "Affine":
        """This layer and another behind it, as one."""
        return Affine(self.weight @ other.weight, self.bias @ other.weight + other.bias)

    def centred(self) -> "Affine":
        """Takes the mean over the outputs away."""
        mean = self.weight.mean(axis=1, keepdims=True)
        return Affine(self.weight - mean, self.bias - self.bias.mean())

    def ready(self) -> "Ready":
        """The layer as it runs."""
        return Ready(float32(self.weight), float32(self.bias))


class Ready(NamedTuple):
    """An `Affine` in float32."""

    weight: Array
    bias: Array

    def __call__(self, x: Array) -> Array:
        """Maps (..., inputs) to (..., outputs)."""
        y: Array = x @ self.weight
        y += self.bias
        return y


def linear(tensors: Tensors, name: str, inputs: int, outputs: int) -> Affine:
    """Takes the weights of an `nn.Linear`."""
    weight = tensors.take(f"{name}.weight", outputs, inputs)
    return Affine(weight.T, tensors.take(f"{name}.bias", outputs))


def norm_gain(tensors: Tensors, name: str, width: int) -> tuple[Exact, Exact]:
    """Takes gain and bias of an `nn.LayerNorm`."""
    return tensors.take(f"{name}.weight", width), tensors.take(f"{name}.bias", width)


class NormedLayer:
    """A layer, the norm behind it and an activation."""

    def __init__(
        self, layer: Affine, norm: tuple[Exact, Exact], activation: Callable[[Array], Array]
    ) -> None:
        self._layer = layer.centred().ready()
        self._gain, self._bias = (float32(part) for part in norm)
        self._activation = activation

    def __call__(self, x: Array) -> Array:
        """Maps (n, inputs) to (n, outputs)."""
        y = normed(self._layer(x))
        y *= self._gain
        y += self._bias
        return self._activation(y)


def float32(array: Exact) -> Array:
    """Contiguous and in single precision."""
    return np.ascontiguousarray(array, dtype=np.float32)


def normed(x: Array, epsilon: float = LAYER_NORM_EPSILON) -> Array:
    """Divides rows (n, width) of zero mean by their standard deviation."""
    variance = np.einsum("ij,ij->i", x, x)
    variance *= 1.0 / x.shape[1]
    variance += epsilon
    np.sqrt(variance, out=variance)
    y: Array = x / variance[:, None]
    return y


def gelu_tanh(x: Array) -> Array:
    """GELU in its tanh form; overwrites x."""
    y = x * x
    y *= _TANH_CUBIC
    y += _TANH_SCALE
    y *= x
    return _gate(x, y)


def gelu(x: Array) -> Array:
    """GELU; overwrites x. A fitted tanh costs a third of SciPy's erf."""
    square = x * x
    np.minimum(square, _ERF_END, out=square)
    y = square * _ERF_TERMS[-1]
    for term in _ERF_TERMS[-2:0:-1]:
        y += term
        y *= square
    y += _ERF_TERMS[0]
    y *= x
    return _gate(x, y)


def _gate(x: Array, y: Array) -> Array:
    """X (1 + tanh y) / 2; overwrites both."""
    np.tanh(y, out=y)
    y += 1.0
    x *= 0.5
    x *= y
    return x


def relu(x: Array) -> Array:
    """Overwrites x."""
    return np.maximum(x, 0.0, out=x)


def softmax(x: Array) -> Array:
    """Softmax over the last axis; overwrites x."""
    x -= x.max(axis=-1, keepdims=True)
    np.exp(x, out=x)
    x /= x.sum(axis=-1, keepdims=True)
    return x
