"""Grouping of a cloud into patches: farthest-point centres and their nearest points.

The first centre is the point farthest from the cloud's mean, so the patches depend neither on the
order of the points nor on the frame. Method: Yu et al., Point-BERT, CVPR 2022 (as in CORN).
"""

import numpy as np
from numpy.typing import NDArray


def group_patches(
    cloud: NDArray[np.float32], patches: int, patch_size: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Groups one cloud.

    Args:
        cloud: points (N, 3), any rigid frame, N >= max(patches, patch_size).

    Returns:
        Indices of the centres (patches,), and indices of each patch's points
        (patches, patch_size), nearest first; patches may overlap.
    """
    count = len(cloud)
    # About the mean, where squares are small and their differences exact.
    cloud = cloud - cloud.mean(axis=0)
    half_square = 0.5 * np.einsum("ij,ij->i", cloud, cloud)
    ones = np.ones_like(half_square)
    left = np.column_stack([-cloud, ones, half_square])
    right = np.ascontiguousarray(np.column_stack([cloud, half_square, ones]).T)
    # Row i: half the squared distances from centre i.
    distance = np.empty((patches, count), dtype=np.float32)
    centres = np.empty(patches, dtype=np.intp)
    centre = half_square.argmax()
    nearest = np.full(count, np.inf, dtype=np.float32)
    for i, row in enumerate(distance):
        centres[i] = centre
        np.matmul(left[centre], right, out=row)
        np.minimum(nearest, row, out=nearest)
        centre = nearest.argmax()
    return centres, _nearest_first(distance, patch_size)


def _nearest_first(distance: NDArray[np.float32], k: int) -> NDArray[np.intp]:
    """Columns of the k least entries of every row, least first; one sort instead of two.

    A non-negative float orders as its bits do, so the index goes into the lowest bits. Distances
    that agree to 2^-14 (among 512 points; to 2^-11 among 4096) may swap; the network cannot tell
    them apart within the sensor's noise.
    """
    mask = (1 << (distance.shape[1] - 1).bit_length()) - 1
    keys = np.maximum(distance, 0.0).view(np.uint32)
    keys &= np.uint32(0xFFFFFFFF ^ mask)
    keys |= np.arange(distance.shape[1], dtype=np.uint32)
    keys.sort(axis=1)
    return (keys[:, :k] & np.uint32(mask)).astype(np.intp)
