"""Where the tool should be: its reference, which moves at the speed of the stage.

The tool follows the reference. Moving the measured tool pose by fixed steps instead would make the
push as fast as the arm's lag allows, which differs between integrators; a moving reference arrives
at the same time whatever the lag.
"""

from typing import cast

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RotationMatrix

from keypush.planning.finger import lowest_corner
from keypush.planning.plan_state import UNDECIDED, PlanState, PushObservation, Stage
from keypush.planning.push_frame import left_of, rotation_vector, tool_rotation
from keypush.scenario import ControlConfig, PlannerConfig, TableConfig

Array = NDArray[np.float64]

# Lengths in m, steps in policy steps.
_TOUCH_STEPS = 8
"""So long a push is slow where the tool may first touch the object."""
_GAIN_STEPS = 5
"""And so long it takes from there to its full speed."""
_GIVE_WAY = 0.01
"""How far behind the tool its reference is while it gives way, m."""
_START_ABOVE = 0.005
"""A push starts this much above its height, m."""
_SCRAPE = 0.0025
"""How far below its height a tool that presses down slides on the table, m."""
_PUSH_LEAD = 0.012
"""How far ahead of the tool a push's reference may be, m: an arm that is held up would
otherwise shoot forward later."""
_RISEN = (0.0, 0.003)
"""Rise of a pushing tool above its height at which the lead begins to shrink, and is gone, m."""
_PRESS = 0.003
"""How far below the tool the reference of a push may be, m: about 1 N downwards."""
_PRESS_BAND = 0.001
"""Where the tool slides on the table it presses half as much; so far above it presses all it may,
so far below not at all, m. A press that was switched there let the tool hop, and the object too."""
_EDGE = 0.01
"""Where the tool tip is this far inside the table's edge, the fingers' lowest corner is, too, m."""
_OVERHEAD = 0.04
"""Distance from the point of descent within which the tool may go below that height, m."""


class ToolReference:
    """The reference in every stage; all methods are pure functions."""

    def __init__(
        self, config: PlannerConfig, control: ControlConfig, table: TableConfig, period: float
    ) -> None:
        """Args: stage constants, clips of the action, table, period of the policy in s."""
        self._config = config
        self._period = period
        self._pitch = float(np.deg2rad(config.pitch_deg))
        self._wrist_yaw = float(np.deg2rad(config.wrist_yaw_deg))
        self._over_table = np.array([table.length, table.width]) / 2 - _EDGE
        # Within these the clip of the action does not bind.
        self._lead = control.max_translation / config.tracking_gain
        self._turn_lead = control.max_rotation / config.tracking_gain

    def height(self, state: PlanState) -> float:
        """Returns the height of a pushing tool's tip, m.

        A steeper tool is lower, so that its finger is as low as otherwise.
        """
        pitch = self._pitch if state.posture == UNDECIDED else state.posture.pitch
        usual, mine = (lowest_corner(p, self._wrist_yaw) for p in (self._pitch, pitch))
        return self._config.tool_height + mine - usual

    @staticmethod
    def beside(seen: PushObservation, forward: float, left: float, height: float) -> Array:
        """Returns where a push starts that begins so far along d from the contact, and left of it.

        Args:
            seen: tells the contact and d.
            forward: along d, m.
            left: to the left of d, m.
            height: of the push, m.
        """
        point = seen.p_WK + forward * seen.d_W + left * left_of(seen.d_W)
        return np.array([point[0], point[1], height + _START_ABOVE])

    def behind(self, state: PlanState, seen: PushObservation) -> Array:
        """Returns where the tool comes down behind the contact, (3,) in W."""
        return self.beside(seen, -self._config.approach_margin, 0.0, self.height(state))

    def above(self, state: PlanState, seen: PushObservation) -> Array:
        """Returns where the tool begins to come down, (3,) in W.

        It is high up while the tool may still be over the object.
        """
        behind = self.behind(state, seen)
        away = np.hypot(*(seen.X_WE.translation() - behind)[:2]) > _OVERHEAD
        behind[2] = self._config.approach_height if away else state.posture.height
        return behind

    def wanted_rotation(self, state: PlanState, seen: PushObservation) -> RotationMatrix:
        """Returns R_WE of a tool that faces along d in the chosen posture."""
        posture = state.posture
        return tool_rotation(seen.d_W, posture.pitch, posture.side, self._wrist_yaw)

    def move(self, state: PlanState, seen: PushObservation) -> Array:
        """Returns the reference's next position, (3,) in W."""
        free = self._config.free_speed * self._period
        if state.waiting:
            target = seen.X_WE.translation() - _GIVE_WAY * seen.d_W
            step = free
        elif state.stage == Stage.PUSH:
            step = self._push_step(state)
            target = self._push_target(state, seen, step)
        elif state.stage == Stage.RISE:
            target = state.p_WR + np.array([0.0, 0.0, free])
            step = free
        else:
            target, step = {
                Stage.APPROACH: (self.above(state, seen), free),
                Stage.DESCEND: (self.behind(state, seen), free / 2),
                Stage.SETTLE: (self.behind(state, seen), free / 2),
                Stage.RETREAT: (state.p_WT, free / 2),
            }[state.stage]
        return self._step_towards(state, seen, target, step)

    def _step_towards(
        self, state: PlanState, seen: PushObservation, target: Array, step: float
    ) -> Array:
        offset = target - state.p_WR
        distance = float(np.linalg.norm(offset))
        p_WR = target if distance <= step else state.p_WR + offset * (step / distance)
        # The reference must not run away from a tool that is held up.
        p_WE = seen.X_WE.translation()
        lead = np.full(3, self._lead)
        if state.stage == Stage.PUSH:
            lead[:] = _PUSH_LEAD
            lead[:2] *= self.push_share(state, p_WE)
        return np.asarray(p_WE + np.clip(p_WR - p_WE, -lead, lead))

    def push_share(self, state: PlanState, p_WE: Array) -> float:
        """Returns the share of a push's lead that is left where the tool has risen to p_WE (3,).

        What the object answers a push with lifts the arm, and the finger's friction lifts the
        object, which then tips over its far edge; a push that gives way lets both down again.
        """
        rise = float(p_WE[2]) - self.height(state)
        return float(np.clip((_RISEN[1] - rise) / (_RISEN[1] - _RISEN[0]), 0.0, 1.0))

    def _push_step(self, state: PlanState) -> float:
        """How far a push's reference goes: little where it may touch, then more in every step.

        The impact of a tool at full speed tips an object that stands on little, where the force of
        the push that follows would not.
        """
        full = self._config.push_speed
        slow = min(self._config.touch_speed, full)
        gained = float(np.clip((state.touching - _TOUCH_STEPS) / _GAIN_STEPS, 0.0, 1.0))
        speed = slow + gained * (full - slow) if state.touching else full
        return speed * self._period

    def _push_target(self, state: PlanState, seen: PushObservation, step: float) -> Array:
        """One step ahead along d_W, steered towards the line through the contact."""
        left = left_of(seen.d_W)
        error = float((state.p_WR - seen.p_WK) @ left)
        steer = np.clip(-self._config.lateral_gain * error / 0.01, -1.0, 1.0)
        heading = seen.d_W + steer * left
        target = state.p_WR + step * heading / np.linalg.norm(heading)
        p_WE = seen.X_WE.translation()
        target[2] = p_WE[2] + self._climb(state, p_WE)
        return np.asarray(target)

    def _climb(self, state: PlanState, p_WE: Array) -> float:
        """How much a pushing tool goes up, or down where it is below zero.

        A tool that rises drags the object up with it and tips it, so it comes from above
        and keeps pressing down, except beside the table, whose edge would be in its way.
        """
        height = self.height(state)
        if np.any(np.abs(p_WE[:2]) > self._over_table):
            return float(np.clip(height - p_WE[2], -_PRESS, _PRESS))
        above = float(p_WE[2]) - (height - _SCRAPE)
        return float(np.clip(-_PRESS / 2 * (1 + above / _PRESS_BAND), -_PRESS, _PRESS))

    def turn(self, state: PlanState, seen: PushObservation) -> RotationMatrix:
        """Returns the reference's next orientation R_WR."""
        if state.stage == Stage.RETREAT or state.posture == UNDECIDED:
            return state.R_WR
        R_WG = self.wanted_rotation(state, seen)
        R_WR = _turn_towards(state.R_WR, R_WG, self._config.turn_rate * self._period)
        return _turn_towards(seen.X_WE.rotation(), R_WR, self._turn_lead)


def _turn_towards(R_WA: RotationMatrix, R_WB: RotationMatrix, step: float) -> RotationMatrix:
    """Returns A turned towards B by at most `step` rad."""
    vector = rotation_vector(R_WA, R_WB)
    angle = float(np.linalg.norm(vector))
    if angle <= step:
        return R_WB
    turn = RotationMatrix(AngleAxis(step, vector / angle))
    return cast(RotationMatrix, turn.multiply(R_WA))
