"""The keypoint that a frame teaches: where the push that it belongs to touches the object."""

import numpy as np
from numpy.typing import NDArray

from keypush.dataset.poses import rotations
from keypush.planning.plan_state import Stage

Points = NDArray[np.float64]


def keypoints(
    stage: NDArray[np.integer],
    object_pose: NDArray[np.floating],
    contact: NDArray[np.floating],
    episode: NDArray[np.integer],
) -> Points:
    """Returns the label p_WK of each frame, (n, 3); NaN for frames that teach nothing.

    It is the contact of the push that the frame belongs to. A frame that pushes with contact has
    the contact measured there. Any other frame has the next such contact of its episode, as it
    lies on the object: carried in O to the frame's pose. Nothing is taught where none follows,
    and where the tool has halted.

    Args:
        stage: of the expert, (n,).
        object_pose: X_WO, (n, 7).
        contact: measured contact in W, NaN without, (n, 3).
        episode: tells the episodes apart, (n,); their frames stand one after the other.
    """
    n = len(stage)
    touches = (stage == Stage.PUSH) & np.isfinite(contact).all(axis=1)
    following = np.where(touches, np.arange(n), n)
    following = np.minimum.accumulate(following[::-1])[::-1]
    exists = following < n
    following[~exists] = 0
    exists &= episode[following] == episode
    R_WO, p_WO = rotations(object_pose), np.asarray(object_pose[:, 4:], dtype=np.float64)
    contact_O = np.einsum("nij,ni->nj", R_WO[following], contact[following] - p_WO[following])
    p_WK = np.einsum("nij,nj->ni", R_WO, contact_O) + p_WO
    p_WK[~exists | (stage == Stage.HALTED)] = np.nan
    return np.asarray(p_WK)
