import numpy as np
import torch
from hypothesis import given
from hypothesis import strategies as st

from keypush.learning.inference.patches import group_patches
from keypush.learning.patches import group_patches_batch

SEEDS = st.integers(0, 2**32 - 1)


def _cloud(seed: int, count: int = 100) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, 3)).astype(np.float32)


@given(SEEDS)
def test_centres_are_farthest_points_and_members_nearest(seed: int) -> None:
    cloud = _cloud(seed)
    centres, members = group_patches(cloud, 8, 12)
    distance = np.linalg.norm(cloud[:, None] - cloud[None], axis=2)
    from_mean = np.linalg.norm(cloud - cloud.mean(axis=0), axis=1)
    assert from_mean[centres[0]] >= from_mean.max() - 1e-5
    for i in range(1, 8):
        gap = distance[centres[:i]].min(axis=0)
        assert gap[centres[i]] >= gap.max() - 1e-4
    for centre, patch in zip(centres, members, strict=True):
        nearest = np.sort(distance[centre])[:12]
        # Near-equal distances may swap: see `_nearest_first`.
        np.testing.assert_allclose(distance[centre, patch], nearest, rtol=1e-3, atol=2e-3)
        assert len(set(patch.tolist())) == 12
        assert patch[0] == centre


@given(SEEDS)
def test_order_of_the_points_does_not_matter(seed: int) -> None:
    cloud = _cloud(seed)
    order = np.random.default_rng(seed + 1).permutation(len(cloud))
    centres, members = group_patches(cloud, 8, 12)
    shuffled_centres, shuffled_members = group_patches(cloud[order], 8, 12)
    np.testing.assert_array_equal(cloud[centres], cloud[order][shuffled_centres])
    distance = np.linalg.norm(cloud[members] - cloud[centres][:, None], axis=2)
    shuffled = cloud[order]
    other = np.linalg.norm(shuffled[shuffled_members] - cloud[centres][:, None], axis=2)
    np.testing.assert_allclose(distance, other, rtol=1e-3, atol=2e-3)


def test_batch_agrees_with_single_clouds() -> None:
    clouds = np.stack([_cloud(seed, 512) for seed in range(8)])
    centres, members = group_patches_batch(torch.tensor(clouds), 16, 32)
    for i, cloud in enumerate(clouds):
        single_centres, single_members = group_patches(cloud, 16, 32)
        np.testing.assert_array_equal(centres[i], single_centres)
        assert (members[i].numpy() == single_members).mean() > 0.99


def test_patch_may_hold_every_point() -> None:
    _, members = group_patches(_cloud(0, 16), 2, 16)
    np.testing.assert_array_equal(np.sort(members, axis=1), np.tile(np.arange(16), (2, 1)))
