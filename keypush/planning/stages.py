"""The stages of a push: over and behind the contact, down, settle, push, and again if needed.

The planner moves a reference for the tool at set speeds, and the tool follows it. Moving
the measured tool pose by fixed steps instead would make the push as fast as the arm's
lag allows, which differs between integrators; a moving reference arrives at the same
time whatever the lag.
"""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import AngleAxis, Quaternion
from pydrake.math import RigidTransform, RotationMatrix

from keypush.planning.push_frame import left_of, rotation_vector, tool_rotation
from keypush.scenario import ControlConfig, PlannerConfig

Array = NDArray[np.float64]

_Z = np.array([0.0, 0.0, 1.0])
_APPROACH_TOLERANCE = 0.015
_TURN_TOLERANCE = 0.12
_SETTLE_HEIGHT_TOLERANCE = 0.004
_SETTLE_TOLERANCE = 0.008
_SETTLE_STEPS = 12
_ARRIVED = 0.003
_REAPPROACH_STEPS = 3
_LOW_PATH_BEHIND = 0.02
_LOW_PATH_BESIDE = 0.06
_RETREAT_STEPS = 15


class Stage(IntEnum):
    """What the tool is doing."""

    RISE = 0
    APPROACH = 1
    DESCEND = 2
    SETTLE = 3
    PUSH = 4
    RETREAT = 5
    HALTED = 6


@dataclass(frozen=True)
class PlanState:
    """What a planner remembers between policy steps."""

    stage: Stage
    side: int
    """Which way the wrist is turned, +1 or -1; 0 while not yet chosen."""
    steps: int
    """Policy steps spent in the stage."""
    strikes: int
    """Consecutive pushing steps with too large a lateral error."""
    R_WR: RotationMatrix
    """Orientation of the reference R that the tool follows."""
    p_WR: Array
    """(3,) position of the reference."""
    p_WT: Array
    """(3,) where a retreat goes."""

    SIZE = 14

    def to_vector(self) -> Array:
        """Packs the state for a Context."""
        quaternion = self.R_WR.ToQuaternion().wxyz()
        counts = [float(self.stage), float(self.side), float(self.steps), float(self.strikes)]
        return np.concatenate([counts, quaternion, self.p_WR, self.p_WT])

    @staticmethod
    def from_vector(x: Array) -> "PlanState":
        """Unpacks `to_vector`."""
        return PlanState(
            stage=Stage(round(x[0])),
            side=round(x[1]),
            steps=round(x[2]),
            strikes=round(x[3]),
            R_WR=RotationMatrix(Quaternion(x[4:8])),
            p_WR=np.array(x[8:11]),
            p_WT=np.array(x[11:14]),
        )

    @staticmethod
    def start(X_WE: RigidTransform) -> "PlanState":
        """The state at the start of an episode: the reference is the tool itself."""
        p_WE = X_WE.translation()
        return PlanState(Stage.RISE, 0, 0, 0, X_WE.rotation(), p_WE, p_WE)


@dataclass(frozen=True)
class PushObservation:
    """What a planner sees at one policy step; all in W."""

    X_WE: RigidTransform
    """Tool pose."""
    p_WK: Array
    """(3,) contact point to push at."""
    d_W: Array
    """(3,) horizontal unit vector of the push."""
    halted: bool = False
    """Whether the tool must stop."""
    reset_offset: Array | None = None
    """(2,) displacement from the contact, along d and to its left, of a wanted retreat."""


class PushStages:
    """The stage logic: `advance` is a pure function of state and observation."""

    def __init__(self, config: PlannerConfig, control: ControlConfig, period: float) -> None:
        self._config = config
        self._period = period
        self._pitch = float(np.deg2rad(config.pitch_deg))
        self._lead = 0.95 * control.max_translation
        self._turn_lead = 0.95 * control.max_rotation

    def advance(self, state: PlanState, seen: PushObservation) -> PlanState:
        """Returns the state of the next policy step: stage first, then its reference."""
        state = self._choose_stage(state, seen)
        if state.stage == Stage.HALTED:
            return state
        p_WR = self._move(state, seen)
        return replace(state, p_WR=p_WR, R_WR=self._turn(state, seen))

    def action(self, state: PlanState, X_WE: RigidTransform) -> Array:
        """Returns the residual tool action (6,): translation in m, axis-angle in rad, in W."""
        return np.concatenate(
            [state.p_WR - X_WE.translation(), rotation_vector(X_WE.rotation(), state.R_WR)]
        )

    # Which stage -----------------------------------------------------------------------

    def _choose_stage(self, state: PlanState, seen: PushObservation) -> PlanState:
        if seen.halted:
            return self._enter(state, Stage.HALTED)
        if state.side == 0:
            state = replace(state, side=self._nearer_side(seen))
        choose = {
            Stage.RISE: self._after_rise,
            Stage.APPROACH: self._after_approach,
            Stage.DESCEND: self._after_descend,
            Stage.SETTLE: self._after_settle,
            Stage.PUSH: self._after_push,
            Stage.RETREAT: self._after_retreat,
            Stage.HALTED: lambda state, seen: state,
        }[state.stage]
        chosen = choose(replace(state, steps=state.steps + 1), seen)
        return chosen

    @staticmethod
    def _enter(state: PlanState, stage: Stage) -> PlanState:
        if state.stage == stage:
            return state
        return replace(state, stage=stage, steps=0, strikes=0)

    def _nearer_side(self, seen: PushObservation) -> int:
        R_WE = seen.X_WE.rotation()
        angles = {
            side: np.linalg.norm(rotation_vector(R_WE, tool_rotation(seen.d_W, self._pitch, side)))
            for side in (1, -1)
        }
        return 1 if angles[1] <= angles[-1] else -1

    def _after_rise(self, state: PlanState, seen: PushObservation) -> PlanState:
        if seen.X_WE.translation()[2] > self._config.approach_height - 0.02:
            return replace(self._enter(state, Stage.APPROACH), side=self._nearer_side(seen))
        return state

    def _after_approach(self, state: PlanState, seen: PushObservation) -> PlanState:
        off = seen.X_WE.translation() - self._above(seen)
        turn = rotation_vector(
            seen.X_WE.rotation(), tool_rotation(seen.d_W, self._pitch, state.side)
        )
        if np.linalg.norm(off) < _APPROACH_TOLERANCE and np.linalg.norm(turn) < _TURN_TOLERANCE:
            return self._enter(state, Stage.DESCEND)
        return state

    def _after_descend(self, state: PlanState, seen: PushObservation) -> PlanState:
        if np.linalg.norm(state.p_WR - self._behind(seen)) < _ARRIVED:
            return self._enter(state, Stage.SETTLE)
        return state

    def _after_settle(self, state: PlanState, seen: PushObservation) -> PlanState:
        off = seen.X_WE.translation() - self._behind(seen)
        still = abs(off[2]) < _SETTLE_HEIGHT_TOLERANCE and np.hypot(*off[:2]) < _SETTLE_TOLERANCE
        if still or state.steps > _SETTLE_STEPS:
            return self._enter(state, Stage.PUSH)
        return state

    def _after_push(self, state: PlanState, seen: PushObservation) -> PlanState:
        if seen.reset_offset is not None:
            forward, left = seen.reset_offset
            p_WT = self._beside(seen, forward, left)
            return replace(self._enter(state, Stage.RETREAT), p_WT=p_WT)
        off = seen.X_WE.translation() - seen.p_WK
        missed = abs(off @ left_of(seen.d_W)) > self._config.reapproach_error
        state = replace(state, strikes=state.strikes + 1 if missed else 0)
        if state.strikes < _REAPPROACH_STEPS:
            return state
        p_WT = seen.X_WE.translation() - self._config.approach_margin * self._heading(seen)
        p_WT[2] = self._config.tool_height
        return replace(self._enter(state, Stage.RETREAT), p_WT=p_WT)

    def _after_retreat(self, state: PlanState, seen: PushObservation) -> PlanState:
        p_WE = seen.X_WE.translation()
        if np.linalg.norm(p_WE - state.p_WT) > 0.01 and state.steps < _RETREAT_STEPS:
            return state
        off = p_WE - seen.p_WK
        behind = off @ seen.d_W < -_LOW_PATH_BEHIND
        if behind and abs(off @ left_of(seen.d_W)) < _LOW_PATH_BESIDE:
            return self._enter(state, Stage.DESCEND)
        return self._enter(state, Stage.RISE)

    # Where to --------------------------------------------------------------------------

    def _beside(self, seen: PushObservation, forward: float, left: float) -> Array:
        point = seen.p_WK + forward * seen.d_W + left * left_of(seen.d_W)
        return np.array([point[0], point[1], self._config.tool_height])

    def _behind(self, seen: PushObservation) -> Array:
        return self._beside(seen, -self._config.approach_margin, 0.0)

    def _above(self, seen: PushObservation) -> Array:
        behind = self._behind(seen)
        behind[2] = self._config.approach_height
        return behind

    def _heading(self, seen: PushObservation) -> Array:
        """The tool's own horizontal heading, which lags behind d_W while it turns."""
        z_axis = seen.X_WE.rotation().matrix()[:, 2]
        heading = np.array([z_axis[0], z_axis[1], 0.0])
        length = float(np.linalg.norm(heading))
        return heading / length if length > 1e-6 else seen.d_W

    def _move(self, state: PlanState, seen: PushObservation) -> Array:
        free = self._config.free_speed * self._period
        if state.stage == Stage.PUSH:
            target = self._push_target(state, seen)
            step = self._config.push_speed * self._period
        elif state.stage == Stage.RISE:
            target = state.p_WR + np.array([0.0, 0.0, free])
            step = free
        else:
            target, step = {
                Stage.APPROACH: (self._above(seen), free),
                Stage.DESCEND: (self._behind(seen), free / 2),
                Stage.SETTLE: (self._behind(seen), free / 2),
                Stage.RETREAT: (state.p_WT, free / 2),
            }[state.stage]
        offset = target - state.p_WR
        distance = float(np.linalg.norm(offset))
        p_WR = target if distance <= step else state.p_WR + offset * (step / distance)
        # The reference must not run away from a tool that is held up.
        p_WE = seen.X_WE.translation()
        return np.asarray(p_WE + np.clip(p_WR - p_WE, -self._lead, self._lead))

    def _push_target(self, state: PlanState, seen: PushObservation) -> Array:
        """One step ahead along d_W, steered towards the line through the contact."""
        step = self._config.push_speed * self._period
        left = left_of(seen.d_W)
        error = float((state.p_WR - seen.p_WK) @ left)
        steer = np.clip(-self._config.lateral_gain * error / 0.01, -1.0, 1.0)
        heading = seen.d_W + steer * left
        target = state.p_WR + step * heading / np.linalg.norm(heading)
        target[2] = self._config.tool_height
        return np.asarray(target)

    def _turn(self, state: PlanState, seen: PushObservation) -> RotationMatrix:
        if state.stage == Stage.RETREAT:
            return state.R_WR
        R_WG = tool_rotation(seen.d_W, self._pitch, state.side)
        R_WR = _turn_towards(state.R_WR, R_WG, self._config.turn_rate * self._period)
        return _turn_towards(seen.X_WE.rotation(), R_WR, self._turn_lead)


def _turn_towards(R_WA: RotationMatrix, R_WB: RotationMatrix, step: float) -> RotationMatrix:
    """Returns A turned towards B by at most `step` rad."""
    vector = rotation_vector(R_WA, R_WB)
    angle = float(np.linalg.norm(vector))
    if angle <= step:
        return R_WB
    return RotationMatrix(AngleAxis(step, vector / angle)) @ R_WA
