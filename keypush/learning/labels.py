"""The keypoint that a row of an expert episode teaches."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from keypush.learning.rows import Rows

PUSH = 4
"""The stage in which the tool pushes."""
HALTED = 6
"""The stage in which nothing is left to do."""

Points = NDArray[np.float64]


def make_labels(rows: Rows, label: str) -> Points:
    """Returns p_WK of every row, (n, 3); NaN for rows that teach nothing.

    Args:
        rows: ordered by episode and step.
        label: "measured": the contact of the push that the row belongs to (see
            `measured_contact`); "analytic": where the expert aims (see `aimed_contact`).
    """
    p_WK = measured_contact(rows) if label == "measured" else aimed_contact(rows)
    p_WK[rows.stage == HALTED] = np.nan
    return p_WK


def measured_contact(rows: Rows) -> Points:
    """Returns the contact of each row's push in W, (n, 3); NaN where none follows.

    A row that pushes with contact has the contact measured there. Any other row has the next
    such contact of its episode, as it lies on the object: carried in O to the row's pose.
    """
    n = len(rows)
    touches = (rows.stage == PUSH) & np.isfinite(rows.contact_point).all(axis=1)
    following = np.where(touches, np.arange(n), n)
    following = np.minimum.accumulate(following[::-1])[::-1]
    exists = following < n
    following[~exists] = 0
    exists &= rows.episode[following] == rows.episode
    R_WO, p_WO = rotations(rows.object_pose), rows.object_pose[:, 4:]
    contact_O = np.einsum(
        "nij,ni->nj", R_WO[following], rows.contact_point[following] - p_WO[following]
    )
    p_WK = np.einsum("nij,nj->ni", R_WO, contact_O) + p_WO
    p_WK[~exists] = np.nan
    return np.asarray(p_WK)


def aimed_contact(rows: Rows) -> Points:
    """Returns the expert's analytic contact at each row's pose, (n, 3); NaN for last rows.

    A row is logged before the planner acts on it, so the planner's answer to it is the target in
    the next row.
    """
    p_WK = np.full_like(rows.target, np.nan)
    same = rows.episode[1:] == rows.episode[:-1]
    p_WK[:-1][same] = rows.target[1:][same]
    return p_WK


def rotations(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the rotation matrices (n, 3, 3) of poses (n, 7), quaternion first, scalar first."""
    return np.asarray(Rotation.from_quat(poses[:, :4], scalar_first=True).as_matrix())
