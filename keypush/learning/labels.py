"""The keypoint that a row of an expert episode teaches."""

import numpy as np
from numpy.typing import NDArray

from keypush.dataset.keypoint import keypoints
from keypush.learning.rows import Rows
from keypush.planning.plan_state import Stage


def make_labels(rows: Rows, label: str) -> NDArray[np.float64]:
    """Returns p_WK of every row, (n, 3); NaN for rows that teach nothing.

    Args:
        rows: ordered by episode and step.
        label: "measured": the contact of the push that the row belongs to, which is also the
            field `keypoint` of the data set; "analytic": where the expert aims, NaN in an
            episode's last row.
    """
    if label == "measured":
        return keypoints(rows.stage, rows.object_pose, rows.contact_point, rows.episode)
    p_WK = rows.target.copy()
    p_WK[rows.stage == Stage.HALTED] = np.nan
    return p_WK
