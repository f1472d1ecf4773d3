"""Scenes and untrained networks that the learning tests share."""

from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from keypush.learning.kinds import read_sizes
from keypush.learning.model import PolicyModel
from keypush.learning.predict import read_model
from keypush.networks.config import SurfaceConfig
from keypush.networks.surface_keypoint_network import SurfaceKeypointNetwork

SMALL = SurfaceConfig(patches=4, patch_size=8, width=16, patch_width=16, heads=2, query_heads=2)


def make_network(config: SurfaceConfig = SMALL, seed: int = 0) -> SurfaceKeypointNetwork:
    """An untrained network whose weights follow from the seed."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        return SurfaceKeypointNetwork(config).eval()


def make_cloud(rng: np.random.Generator, count: int = 128) -> NDArray[np.float64]:
    """Points on an ellipsoid that lies somewhere on the table, (count, 3)."""
    points = rng.normal(size=(count, 3))
    points *= [0.05, 0.03, 0.04] / np.linalg.norm(points, axis=1, keepdims=True)
    return np.asarray(points + np.array([*rng.uniform(-0.1, 0.1, 2), 0.04]))


def make_hand(rng: np.random.Generator) -> NDArray[np.float64]:
    """A hand state (9,) whose six rotation entries are two orthonormal columns."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.concatenate([rng.uniform(-0.2, 0.2, 3), q[:, :2].T.ravel()])


def read_keypoint_model(weights: Path) -> PolicyModel:
    """Reads the model of weights of either kind that gives a keypoint."""
    kind, sizes = read_sizes(weights, ["keypoint", "surface_keypoint"])
    return read_model(kind, weights, sizes)
