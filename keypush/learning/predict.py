"""Keypoint models: what the predictor system calls once per policy step."""

from pathlib import Path
from typing import Protocol, override

import numpy as np
from numpy.typing import NDArray

from keypush.errors import UserError
from keypush.learning.checkpoint import load_network
from keypush.learning.forward import NumpyNetwork
from keypush.learning.goal_frame import GoalFrame
from keypush.learning.patches import group_patches
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork

Vector = NDArray[np.float64]


class KeypointModel(Protocol):
    """Chooses where to push."""

    @property
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""

    def predict(
        self,
        cloud_W: NDArray[np.floating],
        goal_W: NDArray[np.floating],
        com_W: NDArray[np.floating] | None,
        hand: NDArray[np.floating],
    ) -> Vector:
        """Returns the keypoint p_WK, shape (3,), in m; same inputs, same bits.

        Args:
            cloud_W: surface points of the object in W, (N, 3), m.
            goal_W: goal of the object's position, xy in W, (2,), m.
            com_W: p_WOcm, (3,), m, or None when it is not observed.
            hand: p_WEo and the first two columns of R_WE, (9,).

        A non-finite result is returned as it is; the caller reports it.
        """


class CentroidKeypoint(KeypointModel):
    """The baseline without learning: the cloud's centroid."""

    @property
    @override
    def uses_com(self) -> bool:
        """False."""
        return False

    @override
    def predict(
        self,
        cloud_W: NDArray[np.floating],
        goal_W: NDArray[np.floating],
        com_W: NDArray[np.floating] | None,
        hand: NDArray[np.floating],
    ) -> Vector:
        """Returns the mean of the cloud; see `KeypointModel.predict`."""
        centroid: Vector = np.mean(cloud_W, axis=0, dtype=float)
        return centroid


class NetworkKeypoint(KeypointModel):
    """A trained `SurfaceKeypointNetwork`."""

    def __init__(self, network: SurfaceKeypointNetwork) -> None:
        self._config = network.config
        self._network = NumpyNetwork(network)

    @property
    @override
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""
        return self._config.use_com

    @override
    def predict(
        self,
        cloud_W: NDArray[np.floating],
        goal_W: NDArray[np.floating],
        com_W: NDArray[np.floating] | None,
        hand: NDArray[np.floating],
    ) -> Vector:
        """Returns the network's keypoint; see `KeypointModel.predict`.

        Raises:
            UserError: the network was trained with the COM and `com_W` is None, or the cloud
                has fewer points than a patch.
        """
        config = self._config
        if config.use_com and com_W is None:
            raise UserError("predictor.use_com is false; allowed: true, as these weights need it")
        least = max(config.patches, config.patch_size)
        if len(cloud_W) < least:
            raise UserError(
                f"noise.cloud_points is {len(cloud_W)}; allowed: at least {least} for these weights"
            )
        com = com_W if config.use_com else None
        frame = GoalFrame.of(cloud_W.mean(axis=0) if com is None else com, goal_W)
        cloud = frame.to_goal(cloud_W)
        centres, members = group_patches(cloud, config.patches, config.patch_size)
        query = frame.to_goal(np.array([goal_W[0], goal_W[1], 0.0]))[:2]
        if com is not None:
            query = np.concatenate([query, frame.to_goal(com)])
        p_GK = self._network(cloud, centres, members, query, frame.hand_to_goal(hand))
        return frame.to_world(p_GK)


def load_keypoint_model(name_or_path: str | Path) -> NetworkKeypoint:
    """Reads a trained model by the name of shipped weights or by path.

    Raises:
        UserError: see `checkpoint.load_network`.
    """
    return NetworkKeypoint(load_network(name_or_path, SurfaceKeypointNetwork))
