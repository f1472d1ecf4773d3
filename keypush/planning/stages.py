"""The stages of a push: over and behind the contact, down, settle, push, and again if needed."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from keypush.control.arm_kinematics import ArmKinematics
from keypush.control.differential_ik import undamped_action
from keypush.control.joint_step import joint_step
from keypush.planning.plan_state import PlanState, PushObservation, Stage
from keypush.planning.posture import REACHED, Posture, choose_posture
from keypush.planning.push_frame import left_of, rotation_vector
from keypush.planning.tool_reference import ToolReference
from keypush.scenario import ControlConfig, PlannerConfig, TableConfig

Array = NDArray[np.float64]

# Lengths in m, angles in rad, steps in policy steps.
_HIGH_ENOUGH = 0.02
_RISE_STEPS = 15
"""An arm that cannot rise on the spot has to go elsewhere after so long."""
_APPROACH_TOLERANCE = 0.015
_TURN_TOLERANCE = 0.12
_SETTLE_HEIGHT_TOLERANCE = 0.002
_SETTLE_TOLERANCE = 0.008
_SETTLED = 2
"""Consecutive steps within the tolerances: a tool that passes by would dive below its height."""
_SETTLE_STEPS = 15
_HELD_OFF = 0.01
"""A tool that stays so far from where it should settle is held off by limits of the joints, m."""
_ARRIVED = 0.003
_REAPPROACH_STEPS = 3
_JAMMED_STEPS = 15
"""So long pressing down may take to let a risen tool down again."""
_STALLED_STEPS = 30
_WAY = 0.002
"""A push that comes no nearer to its end than this in so many steps is barred, m."""
_NEAR = 0.025
"""Distance from the contact within which the tool may touch, m: the fingers reach ahead of its tip,
and the contact is known to about a centimetre."""
_WAIT_STEPS = 6
_TILT_GROWS = np.deg2rad(0.15)
"""Growth of the tilt in a policy step at which a push gives way."""
_UPRIGHT_AGAIN = np.deg2rad(0.7)
_TILT_MORE = np.deg2rad(0.2)
_TILT_MOST = np.deg2rad(2.0)
"""Each time that a push gave way it bears so much more tilt the next time, up to the latter: some
objects lean on the finger while they are pushed, and would never arrive."""
# After a retreat the tool stays low if it is this far behind the contact, and not farther
# than this beside the line of the push; else it goes over the object.
_LOW_PATH_BEHIND = 0.02
_LOW_PATH_BESIDE = 0.06
_RETREAT_STEPS = 15
_RETREATED = 0.01
_CLEAR = 0.025
"""A retreat goes at least so far behind the contact, m: a tool that rises while it still touches
the object lifts it."""
_LARGEST_GAIN = 2.0
"""Bound on undoing the damping of the inverse kinematics near singularities."""
_STEEPER = np.deg2rad([0.0, 5.0, 10.0, 15.0, 20.0])
"""Added to the pitch where the arm cannot reach the push otherwise. At the last the palm is
ahead of the fingers and touches tall objects first, so it is the last resort."""
_MUCH_STEEPER = np.deg2rad(12.0)
_STUCK = 60
"""Policy steps on the way to a push after which the tool rises and tries anew."""
_REHEARSED = 110
"""Policy steps after which a rehearsed way to a push is given up."""
_FOLLOWED = 0.72
"""Share of a joint step that the arm makes before the next one."""
_LOWER = (1.0, 0.75, 0.5)
"""Shares of the approach height that are tried where the arm cannot reach higher."""


class PushStages:
    """The stage logic: `advance` is a pure function of state and observation."""

    def __init__(
        self,
        arm: ArmKinematics,
        config: PlannerConfig,
        control: ControlConfig,
        table: TableConfig,
        period: float,
    ) -> None:
        """Args: arm's kinematics, stage constants, clips of the action, table, period in s."""
        self._arm = arm
        self._config = config
        self._control = control
        self._period = period
        self._reference = ToolReference(config, control, table, period)
        pitch = np.deg2rad(config.pitch_deg)
        self._wrist_yaw = float(np.deg2rad(config.wrist_yaw_deg))
        self._pitches = [float(p) for p in np.minimum(pitch + _STEEPER, np.pi / 2)]

    def advance(self, state: PlanState, seen: PushObservation) -> PlanState:
        """Returns the state of the next policy step: stage first, then its reference."""
        state = self._choose_stage(state, seen)
        if state.stage == Stage.HALTED:
            return state
        p_WR = self._reference.move(state, seen)
        return replace(state, p_WR=p_WR, R_WR=self._reference.turn(state, seen))

    def action(self, state: PlanState, seen: PushObservation) -> Array:
        """Returns the residual tool action (6,): translation in m, axis-angle in rad, in W."""
        offset = state.p_WR - seen.X_WE.translation()
        turn = rotation_vector(seen.X_WE.rotation(), state.R_WR)
        J = self._arm.jacobian(seen.q)
        a = self._config.tracking_gain * np.concatenate([offset, turn])
        return undamped_action(J, a, self._control.damping, _LARGEST_GAIN)

    def reaches(self, seen: PushObservation) -> bool:
        """Whether the arm reaches a push's start, from high above it, and its end, hardly steeper.

        Where it can only be much steeper the arm is stretched, and a push does not stay low;
        where it can only be low above the start, limits of the joints are near.
        """
        usual = [p for p in self._pitches if p - self._pitches[0] < _MUCH_STEEPER]
        return self._choose_posture(seen, usual, _LOWER[:1])[1] < REACHED

    def _choose_stage(self, state: PlanState, seen: PushObservation) -> PlanState:
        if seen.halted:
            return self._enter(state, Stage.HALTED)
        choose: dict[Stage, Callable[[PlanState, PushObservation], PlanState]] = {
            Stage.RISE: self._after_rise,
            Stage.APPROACH: self._after_approach,
            Stage.DESCEND: self._after_descend,
            Stage.SETTLE: self._after_settle,
            Stage.PUSH: self._after_push,
            Stage.RETREAT: self._after_retreat,
            Stage.HALTED: lambda state, _: state,
        }
        return choose[state.stage](replace(state, steps=state.steps + 1), seen)

    @staticmethod
    def _enter(state: PlanState, stage: Stage) -> PlanState:
        if state.stage == stage:
            return state
        return replace(
            state,
            stage=stage,
            steps=0,
            strikes=0,
            barred=False,
            jammed=0,
            stalled=0,
            waiting=0,
            touching=0,
            nearest=np.inf,
        )

    def _choose_posture(
        self,
        seen: PushObservation,
        pitches: Sequence[float],
        lower: Sequence[float] = _LOWER,
        sides: Sequence[int] = (1, -1),
        steps: Callable[[Posture], int | None] | None = None,
    ) -> tuple[Posture, float]:
        end = seen.p_WK + max(seen.distance, 0.0) * seen.d_W
        end[2] = self._config.tool_height
        start = self._reference.beside(
            seen, -self._config.approach_margin, 0.0, self._config.tool_height
        )
        heights = [share * self._config.approach_height for share in lower]
        return choose_posture(
            self._arm,
            seen.q,
            seen.d_W,
            [start, end],
            list(product(pitches, heights)),
            self._wrist_yaw,
            sides,
            steps,
        )

    def _after_rise(self, state: PlanState, seen: PushObservation) -> PlanState:
        high = seen.X_WE.translation()[2] > self._config.approach_height - _HIGH_ENOUGH
        if not high and state.steps <= _RISE_STEPS:
            return state
        posture = self._rehearsed_posture(state, seen)
        return replace(self._enter(state, Stage.APPROACH), posture=posture)

    def _rehearsed_posture(self, state: PlanState, seen: PushObservation) -> Posture:
        """From the other side after a barred way, where the arm reaches all from there."""
        steps = partial(self._steps_to_push, state, seen)
        if state.barred:
            sides = (-state.posture.side,)
            posture, error = self._choose_posture(seen, self._pitches, sides=sides, steps=steps)
            if error < REACHED:
                return posture
        return self._choose_posture(seen, self._pitches, steps=steps)[0]

    def _steps_to_push(
        self, state: PlanState, seen: PushObservation, posture: Posture
    ) -> int | None:
        """Rehearses the way to a push; None where the arm gets stuck.

        That it reaches the poses on the way does not say so: joints come to their limits between.
        """
        state, q = replace(self._enter(state, Stage.APPROACH), posture=posture), seen.q
        for step in range(_REHEARSED):
            now = replace(seen, q=q, X_WE=self._arm.tool_pose(q))
            state = self.advance(state, now)
            if state.stage in (Stage.PUSH, Stage.RISE):
                return step if state.stage == Stage.PUSH else None
            action = self.action(state, now)
            q = q + _FOLLOWED * joint_step(self._arm, q, action, self._control, self._period)
        return None

    def _after_approach(self, state: PlanState, seen: PushObservation) -> PlanState:
        off = seen.X_WE.translation() - self._reference.above(state, seen)
        turn = rotation_vector(seen.X_WE.rotation(), self._reference.wanted_rotation(state, seen))
        if np.linalg.norm(off) < _APPROACH_TOLERANCE and np.linalg.norm(turn) < _TURN_TOLERANCE:
            return self._enter(state, Stage.DESCEND)
        return self._try_anew(state) if state.steps > _STUCK else state

    def _after_descend(self, state: PlanState, seen: PushObservation) -> PlanState:
        if np.linalg.norm(state.p_WR - self._reference.behind(state, seen)) < _ARRIVED:
            return self._enter(state, Stage.SETTLE)
        return self._try_anew(state) if state.steps > _STUCK else state

    def _try_anew(self, state: PlanState) -> PlanState:
        """Rises, and remembers that this side's way is barred."""
        return replace(self._enter(state, Stage.RISE), barred=True)

    def _after_settle(self, state: PlanState, seen: PushObservation) -> PlanState:
        off = seen.X_WE.translation() - self._reference.behind(state, seen)
        still = abs(off[2]) < _SETTLE_HEIGHT_TOLERANCE and np.hypot(*off[:2]) < _SETTLE_TOLERANCE
        state = replace(state, strikes=state.strikes + 1 if still else 0)
        if state.strikes < _SETTLED and state.steps <= _SETTLE_STEPS:
            return state
        if np.linalg.norm(off) > _HELD_OFF:
            return self._try_anew(state)
        return self._enter(state, Stage.PUSH)

    def _after_push(self, state: PlanState, seen: PushObservation) -> PlanState:
        if seen.reset_offset is not None:
            forward, left = seen.reset_offset
            p_WT = self._reference.beside(
                seen, min(forward, -_CLEAR), left, self._reference.height(state)
            )
            return replace(self._enter(state, Stage.RETREAT), p_WT=p_WT)
        state = self._heed_tilt(self._count_troubles(state, seen), seen)
        state = self._count_touch(state, seen)
        if state.strikes < _REAPPROACH_STEPS and not self._barred(state):
            return state
        p_WT = seen.X_WE.translation() - self._config.approach_margin * self._heading(seen)
        p_WT[2] = self._reference.height(state)
        return replace(self._enter(state, Stage.RETREAT), p_WT=p_WT)

    @staticmethod
    def _barred(state: PlanState) -> bool:
        return state.jammed >= _JAMMED_STEPS or state.stalled >= _STALLED_STEPS

    def _count_troubles(self, state: PlanState, seen: PushObservation) -> PlanState:
        off = seen.X_WE.translation() - seen.p_WK
        missed = abs(off @ left_of(seen.d_W)) > self._config.reapproach_error
        risen = self._reference.push_share(state, seen.X_WE.translation()) == 0.0
        nearer = seen.distance < state.nearest - _WAY
        return replace(
            state,
            strikes=state.strikes + 1 if missed else 0,
            jammed=state.jammed + 1 if risen else 0,
            stalled=0 if nearer else state.stalled + 1,
            nearest=seen.distance if nearer else state.nearest,
        )

    @staticmethod
    def _count_touch(state: PlanState, seen: PushObservation) -> PlanState:
        """Counts from where the tool may touch the object, and anew once it gave way."""
        gap = float((seen.p_WK - seen.X_WE.translation()) @ seen.d_W)
        near = not state.waiting and (state.touching > 0 or gap < _NEAR)
        return replace(state, touching=state.touching + 1 if near else 0)

    def _heed_tilt(self, state: PlanState, seen: PushObservation) -> PlanState:
        """Gives way for a while to an object that tilts more and more: so it falls back."""
        waiting, waits = state.waiting, state.waits
        borne = np.deg2rad(self._config.wait_tilt_deg) + min(waits * _TILT_MORE, _TILT_MOST)
        if waiting:
            waiting = 0 if seen.tilt < _UPRIGHT_AGAIN else waiting - 1
        elif seen.tilt > borne and seen.tilt - state.tilt > _TILT_GROWS:
            waiting, waits = _WAIT_STEPS, waits + 1
        return replace(state, tilt=seen.tilt, waiting=waiting, waits=waits)

    def _after_retreat(self, state: PlanState, seen: PushObservation) -> PlanState:
        p_WE = seen.X_WE.translation()
        if np.linalg.norm(p_WE - state.p_WT) > _RETREATED and state.steps < _RETREAT_STEPS:
            return state
        off = p_WE - seen.p_WK
        behind = off @ seen.d_W < -_LOW_PATH_BEHIND
        if behind and abs(off @ left_of(seen.d_W)) < _LOW_PATH_BESIDE:
            return self._enter(state, Stage.DESCEND)
        return self._enter(state, Stage.RISE)

    @staticmethod
    def _heading(seen: PushObservation) -> Array:
        """The tool's own horizontal heading, which lags behind d_W while it turns."""
        z_axis = seen.X_WE.rotation().matrix()[:, 2]
        heading = np.array([z_axis[0], z_axis[1], 0.0])
        length = float(np.linalg.norm(heading))
        return heading / length if length > 1e-6 else seen.d_W
