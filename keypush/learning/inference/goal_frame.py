"""The frame in which the network sees the scene.

Frame G has its origin Go on the table plane below the object's centre, Gx horizontal towards the
goal and Gz up, so a scene that is moved or turned about Wz on the table looks the same in G. Every
length in G is divided by `LENGTH`. Measured: in this frame 12 shapes are enough to generalise,
in W a thousand times as many samples are not.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LENGTH = 0.05
"""Metres per unit of length in G: the radius of a catalogue object."""

Float32 = NDArray[np.float32]


@dataclass(frozen=True)
class GoalFrame:
    """Frame G of one scene.

    Attributes:
        origin: p_WGo_W, shape (3,), z = 0.
        R_WG: shape (3, 3).
    """

    origin: NDArray[np.float64]
    R_WG: NDArray[np.float64]

    @staticmethod
    def of(centre: NDArray[np.floating], goal_W: NDArray[np.floating]) -> "GoalFrame":
        """Makes the frame from the object's centre (first two entries of `centre`) and the goal.

        With the goal exactly at the centre Gx is Wx.
        """
        x, y = float(goal_W[0] - centre[0]), float(goal_W[1] - centre[1])
        distance = float(np.hypot(x, y))
        c, s = (x / distance, y / distance) if distance > 0 else (1.0, 0.0)
        R_WG = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return GoalFrame(np.array([centre[0], centre[1], 0.0], dtype=float), R_WG)

    def to_goal(self, p_W: NDArray[np.floating]) -> Float32:
        """Expresses points (..., 3) of W in G, in units of `LENGTH`."""
        p_G: Float32 = ((p_W - self.origin) @ (self.R_WG / LENGTH)).astype(np.float32)
        return p_G

    def to_world(self, p_G: NDArray[np.floating]) -> NDArray[np.float64]:
        """The inverse of `to_goal`, in metres."""
        p_W: NDArray[np.float64] = p_G @ (self.R_WG.T * LENGTH) + self.origin
        return p_W

    def hand_to_goal(self, hand_W: NDArray[np.floating]) -> Float32:
        """Expresses the hand state (9,) in G: position in units of `LENGTH`, two unit axes."""
        hand_G = np.empty(9, dtype=np.float32)
        hand_G[:3] = self.to_goal(hand_W[:3])
        # The six rotation entries are the first two columns of R_WE, one after the other.
        hand_G[3:] = (hand_W[3:].reshape(2, 3) @ self.R_WG).ravel()
        return hand_G
