"""Networks as models: from what is seen in W to the network's frame, and back."""

from pathlib import Path
from typing import Any, Protocol, override

import numpy as np

from keypush.errors import UserError
from keypush.learning.clips import Clips
from keypush.learning.inference.goal_frame import GoalFrame
from keypush.learning.inference.ops import Array, Index
from keypush.learning.inference.patches import group_patches
from keypush.learning.inference.surface import SurfaceNetwork
from keypush.learning.inference.thesis import ThesisNetwork
from keypush.learning.model import ActionModel, KeypointModel, PolicyModel, Seen, Vector
from keypush.learning.tensors import Tensors
from keypush.networks.config import KeypointConfig, SurfaceConfig
from keypush.networks.normalisation import (
    denormalise_positions,
    normalise_hand,
    normalise_positions,
)


class Forward(Protocol):
    """A network: a `ThesisNetwork`, a `SurfaceNetwork`, or what stands for one."""

    def __call__(
        self, cloud: Array, centres: Index, members: Index, query: Array, hand: Array
    ) -> Array:
        """Maps a scene in the network's frame to its outputs; all in float32.

        Args:
            cloud: (N, 3).
            centres: indices of patch centres, (patches,).
            members: indices of patch points, nearest first, (patches, patch_size).
            query: goal xy and, if the network uses it, COM, (2,) or (5,).
            hand: (9,).
        """


class SurfaceKeypoint(KeypointModel):
    """A `SurfaceKeypointNetwork`."""

    def __init__(self, network: Forward, config: SurfaceConfig) -> None:
        self._config = config
        self._network = network

    @property
    @override
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""
        return self._config.use_com

    @override
    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the network's keypoint; see `KeypointModel.predict`.

        Raises:
            UserError: the cloud has fewer points than a patch.
            RuntimeError: the network was trained with the COM and `com_W` is None.
        """
        config = self._config
        com = _com(com_W, wanted=config.use_com)
        check_cloud_points(len(cloud_W), config)
        frame = GoalFrame.of(cloud_W.mean(axis=0) if com is None else com, goal_W)
        cloud = frame.to_goal(cloud_W)
        centres, members = group_patches(cloud, config.patches, config.patch_size)
        query = frame.to_goal(np.array([goal_W[0], goal_W[1], 0.0]))[:2]
        if com is not None:
            query = np.concatenate([query, frame.to_goal(com)])
        p_GK = self._network(cloud, centres, members, query, frame.hand_to_goal(hand))
        return frame.to_world(p_GK)


class _ThesisModel:
    """One of the thesis' networks, in W."""

    def __init__(self, network: Forward, config: KeypointConfig) -> None:
        self._config = config
        self._network = network

    @property
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""
        return self._config.use_com

    def run(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Array:
        """Returns the network's outputs; errors as `SurfaceKeypoint.predict`."""
        encoder, com = self._config.encoder, _com(com_W, wanted=self._config.use_com)
        check_cloud_points(len(cloud_W), self._config)
        cloud = normalise_positions(cloud_W).astype(np.float32)
        centres, members = group_patches(cloud, encoder.patches, encoder.patch_size)
        query = normalise_positions(np.asarray(goal_W))
        if com is not None:
            query = np.concatenate([query, normalise_positions(com)])
        return self._network(
            cloud,
            centres,
            members,
            query.astype(np.float32),
            normalise_hand(hand).astype(np.float32),
        )


class ThesisKeypoint(_ThesisModel, KeypointModel):
    """A `KeypointNetwork`."""

    @override
    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the network's keypoint; see `KeypointModel.predict`, errors as there."""
        outputs = self.run(cloud_W, goal_W, com_W, hand).astype(np.float64)
        return np.asarray(denormalise_positions(outputs))


class ThesisAction(_ThesisModel, ActionModel):
    """A `BehaviorCloningNetwork`."""

    def __init__(self, network: Forward, config: KeypointConfig, clips: Clips) -> None:
        """Args: the network; its configuration; what its outputs are shares of."""
        super().__init__(network, config)
        self._clips = clips.of_action

    @override
    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the network's action; see `ActionModel.predict`."""
        return self.run(cloud_W, goal_W, com_W, hand).astype(np.float64) * self._clips


_OUTPUTS = {"keypoint": 3, "behavior_cloning": 6}
"""Of the thesis' networks, by kind; see `kinds.KINDS`."""


def make_model(kind: str, network: Forward, sizes: Any, clips: Clips | None = None) -> PolicyModel:
    """Makes the model of a network.

    Args:
        kind: one of `kinds.KINDS`, but not "contact".
        network: the network.
        sizes: its configuration.
        clips: of the action, which "behavior_cloning" needs.
    """
    if kind == "surface_keypoint":
        return SurfaceKeypoint(network, sizes)
    if kind == "keypoint":
        return ThesisKeypoint(network, sizes)
    assert clips is not None
    return ThesisAction(network, sizes, clips)


def fast_network(kind: str, tensors: Tensors, sizes: Any) -> Forward:
    """Makes a network in NumPy; arguments as for `make_model`.

    Raises:
        UserError: the weights do not fit the sizes.
    """
    network: Forward
    if kind == "surface_keypoint":
        network = SurfaceNetwork(tensors, sizes)
    else:
        network = ThesisNetwork(tensors, sizes, _OUTPUTS[kind])
    tensors.finish()
    return network


def read_model(kind: str, weights: Path, sizes: Any) -> PolicyModel:
    """Reads a model from the `.safetensors` file of its weights.

    Raises:
        UserError: see `Tensors.read`, `fast_network` and `Clips.read`.
    """
    clips = Clips.read(weights) if kind == "behavior_cloning" else None
    return make_model(kind, fast_network(kind, Tensors.read(weights), sizes), sizes, clips)


def _com(com_W: Seen | None, *, wanted: bool) -> Seen | None:
    if wanted and com_W is None:
        raise RuntimeError("object_com has no value; these weights use the centre of mass")
    return com_W if wanted else None


def check_cloud_points(points: int, sizes: KeypointConfig | SurfaceConfig) -> None:
    """Checks that a cloud of so many points can be cut into a network's patches.

    Raises:
        UserError: it has fewer points than a patch, or than there are patches.
    """
    patches = sizes.encoder if isinstance(sizes, KeypointConfig) else sizes
    least = max(patches.patches, patches.patch_size)
    if points < least:
        raise UserError(
            f"noise.cloud_points is {points}; allowed: at least {least} for these weights"
        )
