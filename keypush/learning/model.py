"""What a policy asks a model, once per policy step."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Seen = NDArray[np.floating]


class PolicyError(Exception):
    """A policy gave no answer that can be used; the message, one line, says why.

    It ends the episode, which has failed, and not the run.
    """


class KeypointModel(Protocol):
    """Chooses where to push."""

    @property
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""

    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the keypoint p_WK, shape (3,), in m; same inputs, same bits.

        Args:
            cloud_W: surface points of the object in W, (N, 3), m.
            goal_W: goal of the object's position, xy in W, (2,), m.
            com_W: p_WOcm, (3,), m, or None when it is not observed.
            hand: p_WEo and the first two columns of R_WE, (9,).

        A non-finite result is returned as it is; for the caller the policy has failed then.
        """


class ActionModel(Protocol):
    """Chooses what the tool does next."""

    @property
    def uses_com(self) -> bool:
        """Whether `predict` needs `com_W`."""

    def predict(self, cloud_W: Seen, goal_W: Seen, com_W: Seen | None, hand: Seen) -> Vector:
        """Returns the tool action, shape (6,): translation in m, then axis-angle in rad, in W.

        It may be beyond the clips of the scenario; arguments and the rest as for
        `KeypointModel.predict`.
        """


PolicyModel = KeypointModel | ActionModel
