"""What a planner remembers between policy steps, and what it sees in one."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RotationMatrix

from keypush.planning.posture import Posture

Array = NDArray[np.float64]


class Stage(IntEnum):
    """What the tool is doing."""

    RISE = 0
    APPROACH = 1
    DESCEND = 2
    SETTLE = 3
    PUSH = 4
    RETREAT = 5
    HALTED = 6


UNDECIDED = Posture(0, 0.0, 0.0)
"""Stands for a posture that is not chosen yet."""


@dataclass(frozen=True, kw_only=True)
class PlanState:
    """What a planner remembers between policy steps."""

    stage: Stage
    steps: int = 0
    """Policy steps spent in the stage."""
    strikes: int = 0
    """Consecutive steps of a push with too large a lateral error, or of settling in place."""
    barred: bool = False
    """Whether the tool rises because it was stuck on its way."""
    jammed: int = 0
    """Consecutive steps of a push in which the tool is held too high to push."""
    stalled: int = 0
    """Steps since a push last came nearer to its end."""
    waiting: int = 0
    """Steps that a push still gives way to an object that tilts."""
    waits: int = 0
    """How often the pushes of this episode gave way."""
    touching: int = 0
    """Steps of a push since the tool came near the contact, or last gave way; 0 before."""
    posture: Posture
    """How the tool is held."""
    R_WR: RotationMatrix
    """Orientation of the reference R that the tool follows."""
    p_WR: Array
    """(3,) position of the reference."""
    p_WT: Array
    """(3,) where a retreat goes."""
    nearest: float = np.inf
    """The least distance that was left in this push, m."""
    tilt: float = 0.0
    """Of the object in the last step, rad."""

    SIZE = 24

    def to_vector(self) -> Array:
        """Packs the state for a Context."""
        quaternion = self.R_WR.ToQuaternion().wxyz()
        posture = [self.posture.side, self.posture.pitch, self.posture.height]
        counts = [self.stage, self.steps, self.strikes, self.barred, self.jammed, self.stalled]
        waits = [self.waiting, self.waits, self.touching]
        last = [self.nearest, self.tilt]
        return np.concatenate([counts, waits, posture, quaternion, self.p_WR, self.p_WT, last])

    @staticmethod
    def from_vector(x: Array) -> "PlanState":
        """Unpacks `to_vector`."""
        return PlanState(
            stage=Stage(round(x[0])),
            steps=round(x[1]),
            strikes=round(x[2]),
            barred=bool(round(x[3])),
            jammed=round(x[4]),
            stalled=round(x[5]),
            waiting=round(x[6]),
            waits=round(x[7]),
            touching=round(x[8]),
            posture=Posture(round(x[9]), float(x[10]), float(x[11])),
            R_WR=RotationMatrix(Quaternion(x[12:16])),
            p_WR=np.array(x[16:19]),
            p_WT=np.array(x[19:22]),
            nearest=float(x[22]),
            tilt=float(x[23]),
        )

    @staticmethod
    def start(X_WE: RigidTransform) -> "PlanState":
        """The state at the start of an episode: the reference is the tool itself."""
        p_WE = X_WE.translation()
        return PlanState(
            stage=Stage.RISE,
            posture=UNDECIDED,
            R_WR=X_WE.rotation(),
            p_WR=p_WE,
            p_WT=p_WE,
        )


@dataclass(frozen=True)
class PushObservation:
    """What a planner sees at one policy step; all in W."""

    q: Array
    """(7,) joint positions, rad."""
    X_WE: RigidTransform
    """Tool pose."""
    p_WK: Array
    """(3,) contact point to push at."""
    d_W: Array
    """(3,) horizontal unit vector of the push."""
    distance: float
    """How far the contact still has to be pushed, m."""
    halted: bool = False
    """Whether the tool must stop."""
    reset_offset: Array | None = None
    """(2,) displacement from the contact, along d and to its left, of a wanted retreat."""
    tilt: float = 0.0
    """Angle of the object from where it rested at the start, rad; 0 where it is not known."""
