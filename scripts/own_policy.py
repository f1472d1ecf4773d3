"""A policy of your own, as short as one can be: push at the cloud's rearmost point.

Evaluate it on ten unseen objects, and make a page of that:

    keypush evaluate --policy scripts/own_policy.py:RearPoint --objects ood --episodes 5 \
        --out runs/rear_point
    keypush report runs/rear_point --out out/report.html

The page compares it with other policies on the same episodes, if their folders follow.

`RearPoint` has what `keypush.learning.model.KeypointModel` asks for; it need not inherit from it.
One object of it serves many episodes, in any order: it must keep nothing between its answers.
"""

import numpy as np
from numpy.typing import NDArray

HEIGHT = 0.02
"""Of the push above the table, m: low, so that the object does not topple."""
NEAREST = 16
"""So many of the rearmost points are averaged: one alone is mostly noise."""


class RearPoint:
    """Pushes where the object ends, seen from the goal, at a fixed height."""

    uses_com = False  # else `com_W` is the true centre of mass

    def predict(
        self,
        cloud_W: NDArray[np.floating],
        goal_W: NDArray[np.floating],
        com_W: NDArray[np.floating] | None,  # noqa: ARG002 (whoever asks gives all four)
        hand: NDArray[np.floating],  # noqa: ARG002 (see above)
    ) -> NDArray[np.float64]:
        """Returns the keypoint p_WK, (3,), of points (N, 3) and the goal's xy, all in W in m."""
        centre = cloud_W[:, :2].mean(axis=0)
        ahead = (goal_W - centre) / np.linalg.norm(goal_W - centre)
        offsets = cloud_W[:, :2] - centre
        beside = np.abs(offsets @ np.array([-ahead[1], ahead[0]]))
        near = np.flatnonzero(beside <= np.median(beside))  # so that the push goes by the centre
        rear = near[np.argsort(offsets[near] @ ahead)[:NEAREST]]
        return np.array([*cloud_W[rear, :2].mean(axis=0), HEIGHT])
