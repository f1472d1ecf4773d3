"""EpisodeMonitor: success, toppled, fell, timed out; ends the simulation."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiscreteValues,
    EventStatus,
    LeafSystem,
)

from keypush.eval_ports import eval_abstract, eval_vector
from keypush.scenario import EpisodeConfig, TableConfig


class Outcome(IntEnum):
    """How an episode ended, or that it runs."""

    RUNNING = 0
    SUCCESS = 1
    TOPPLED = 2
    FELL = 3
    TIMED_OUT = 4
    POLICY_FAILED = 5
    """Who runs the episode says so; the monitor never finds it."""


_STILL_DISTANCE = 5e-4
"""The tool has stopped when it moves less than this in a policy step, m."""
_LONGEST_STOP = 2.0
"""The settled test does not wait longer than this for the tool to stop, s."""
_OUTCOME, _STEPS, _SETTLED, _HALTED_STEPS, _STILL_STEPS = range(5)
_TOOL = slice(5, 8)
_UP = slice(8, 11)
_COM_HEIGHT = 11


def longest_episode(config: EpisodeConfig) -> float:
    """Returns a time in s by which the monitor has ended every episode."""
    steps = config.max_steps + 3  # the settled test begins and ends at policy steps
    return steps * config.policy_period + _LONGEST_STOP + config.settle_time


class EpisodeMonitor(LeafSystem):
    """Judges the episode once per policy step and ends the simulation.

    @system
    name: EpisodeMonitor
    input_ports:
    - object_pose
    - object_com
    - goal
    - tool_pose
    output_ports:
    - halted
    - verdict
    @endsystem

    ``object_pose``: abstract `RigidTransform`, X_WO in m; ground truth.

    ``object_com``: vector of 3, p_WOcm in m; ground truth.

    ``goal``: vector of 2, goal xy in W in m.

    ``tool_pose``: abstract `RigidTransform`, X_WE in m.

    ``halted``: vector of 1: 1 once the goal was reached, so that the tool stops.

    ``verdict``: vector of 3: the `Outcome` as a number; policy steps until it was known;
    whether the goal still held `settle_time` after the tool's stop (0 or 1).

    Success (thesis, section 4.1): Oo within `goal_radius` of the goal in xy, upright, on
    the table. Upright: tilt below `max_tilt_deg`, and height changes of COM and of the reference
    points (corners of the object's bounding box) below `max_height_change`.
    All against the
    pose at initialisation. An object whose COM is below the table top, or beyond its edges
    in xy, fell, however it is tilted; one that is on the table but not upright has toppled.
    On success the simulation runs on until the settled test.
    """

    def __init__(
        self, p_OR: NDArray[np.float64], config: EpisodeConfig, table: TableConfig
    ) -> None:
        """Makes the monitor of one object.

        Args:
            p_OR: reference points (N, 3) in O in m.
            config: what counts as success and when to stop.
            table: whose top an object can fall off.
        """
        super().__init__()
        self.set_name("episode_monitor")
        self._config = config
        self._table_half = np.array([table.length, table.width]) / 2
        self._p_OR_O = np.asarray(p_OR, dtype=float)
        self._heights = slice(_COM_HEIGHT + 1, _COM_HEIGHT + 1 + len(p_OR))
        self._pose = self.DeclareAbstractInputPort("object_pose", Value(RigidTransform()))
        self._com = self.DeclareVectorInputPort("object_com", 3)
        self._goal = self.DeclareVectorInputPort("goal", 2)
        self._tool = self.DeclareAbstractInputPort("tool_pose", Value(RigidTransform()))
        self._state = self.DeclareDiscreteState(self._heights.stop)
        held = {self.discrete_state_ticket(self._state)}
        self.DeclareVectorOutputPort("halted", 1, self._calc_halted, prerequisites_of_calc=held)
        self.DeclareVectorOutputPort("verdict", 3, self._calc_verdict, prerequisites_of_calc=held)
        self.DeclareInitializationDiscreteUpdateEvent(self._start)
        self.DeclarePeriodicDiscreteUpdateEvent(config.policy_period, 0.0, self._judge)

    def foresee(self, context: Context) -> Outcome:
        """Returns what the update at the context's time will find in an episode that runs.

        For who stops at a policy step, before its updates.
        """
        values = np.array(context.get_discrete_state(0).value())
        values[_STEPS] = self._steps(context)
        return self._outcome(context, values)

    def _start(self, context: Context, state: DiscreteValues) -> EventStatus:
        X_WO: RigidTransform = eval_abstract(self._pose, context)
        values = np.zeros(self._heights.stop)
        values[_TOOL] = eval_abstract(self._tool, context).translation()
        values[_UP] = X_WO.rotation().matrix()[2]
        values[_COM_HEIGHT] = eval_vector(self._com, context)[2]
        values[self._heights] = self._reference_heights(X_WO)
        state.set_value(0, values)
        return EventStatus.Succeeded()

    def _judge(self, context: Context, state: DiscreteValues) -> EventStatus:
        values = np.array(context.get_discrete_state(0).value())
        if values[_OUTCOME] == Outcome.SUCCESS:
            ended = self._settle(context, values)
        else:
            values[_STEPS] = self._steps(context)
            values[_OUTCOME] = self._outcome(context, values)
            ended = values[_OUTCOME] not in (Outcome.RUNNING, Outcome.SUCCESS)
        values[_TOOL] = eval_abstract(self._tool, context).translation()
        state.set_value(0, values)
        if ended:
            return EventStatus.ReachedTermination(self, Outcome(int(values[_OUTCOME])).name)
        return EventStatus.Succeeded()

    def _steps(self, context: Context) -> int:
        return round(context.get_time() / self._config.policy_period)

    def _outcome(self, context: Context, values: NDArray[np.float64]) -> Outcome:
        if not self._on_table(context):
            return Outcome.FELL
        if not self._upright(context, values):
            return Outcome.TOPPLED
        if self._at_goal(context):
            return Outcome.SUCCESS
        if values[_STEPS] >= self._config.max_steps:
            return Outcome.TIMED_OUT
        return Outcome.RUNNING

    def _settle(self, context: Context, values: NDArray[np.float64]) -> bool:
        """Counts the time since the tool stopped; judges and returns True at its end."""
        config = self._config
        values[_HALTED_STEPS] += 1
        p_WE = eval_abstract(self._tool, context).translation()
        moved = float(np.linalg.norm(p_WE - values[_TOOL]))
        if moved < _STILL_DISTANCE or values[_HALTED_STEPS] * config.policy_period > _LONGEST_STOP:
            values[_STILL_STEPS] += 1
        ended = bool(values[_STILL_STEPS] * config.policy_period >= config.settle_time)
        if ended:
            upright = self._on_table(context) and self._upright(context, values)
            values[_SETTLED] = float(upright and self._at_goal(context))
        return ended

    def _on_table(self, context: Context) -> bool:
        p_WOcm = eval_vector(self._com, context)
        return bool(p_WOcm[2] >= 0 and np.all(np.abs(p_WOcm[:2]) <= self._table_half))

    def _at_goal(self, context: Context) -> bool:
        X_WO: RigidTransform = eval_abstract(self._pose, context)
        offset = X_WO.translation()[:2] - eval_vector(self._goal, context)
        return bool(np.hypot(*offset) <= self._config.goal_radius)

    def _upright(self, context: Context, values: NDArray[np.float64]) -> bool:
        X_WO: RigidTransform = eval_abstract(self._pose, context)
        up_then_O, up_now_O = values[_UP], X_WO.rotation().matrix()[2]
        tilt = float(np.arccos(np.clip(up_then_O @ up_now_O, -1.0, 1.0)))
        com_change = abs(eval_vector(self._com, context)[2] - values[_COM_HEIGHT])
        changes = np.abs(self._reference_heights(X_WO) - values[self._heights])
        return bool(
            tilt < np.deg2rad(self._config.max_tilt_deg)
            and com_change < self._config.max_height_change
            and np.all(changes < self._config.max_height_change)
        )

    def _reference_heights(self, X_WO: RigidTransform) -> NDArray[np.float64]:
        return np.asarray(self._p_OR_O @ X_WO.rotation().matrix()[2] + X_WO.translation()[2])

    def _calc_halted(self, context: Context, output: BasicVector) -> None:
        reached = context.get_discrete_state(0).value()[_OUTCOME] == Outcome.SUCCESS
        output.SetFromVector(np.array([float(reached)]))

    def _calc_verdict(self, context: Context, output: BasicVector) -> None:
        values = context.get_discrete_state(0).value()
        output.SetFromVector(values[[_OUTCOME, _STEPS, _SETTLED]])
