"""A tool that is always exactly where its reference was, pushing an object without mass."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from pydrake.math import RigidTransform

from keypush.planning.plan_state import PlanState, PushObservation, Stage
from keypush.planning.posture import solve_ik
from keypush.planning.push_frame import push_direction
from keypush.planning.stages import PushStages
from keypush.scenario import ControlConfig, PlannerConfig, TableConfig
from tests.control.arm import ARM, READY, Array

PERIOD = 0.1
CONFIG, CONTROL = PlannerConfig(), ControlConfig()
STAGES = PushStages(ARM, CONFIG, CONTROL, TableConfig(), PERIOD)
Change = Callable[[PlanState, PushObservation], PushObservation]


@dataclass(frozen=True)
class Step:
    """A policy step: the state before, what was seen, the state after, the action."""

    before: PlanState
    seen: PushObservation
    after: PlanState
    action: Array


class IdealTool:
    """Runs the stages at one contact; while they push, the contact moves with the tool."""

    def __init__(self, p_WK: Array, goal: Array, q: Array = READY) -> None:
        self.p_WK, self.goal, self.q = np.array(p_WK), goal, q
        self.X_WE: RigidTransform = ARM.tool_pose(q)
        self.state = PlanState.start(self.X_WE)

    def see(self) -> PushObservation:
        distance = float(np.hypot(*(self.goal - self.p_WK[:2])))
        d_W = push_direction(self.p_WK, self.goal)
        return PushObservation(self.q, self.X_WE, self.p_WK, d_W, distance)

    def step(self, change: Change = lambda _, seen: seen) -> Step:
        """Takes one policy step; `change` may alter what the planner sees."""
        before, seen = self.state, change(self.state, self.see())
        after = STAGES.advance(before, seen)
        taken = Step(before, seen, after, STAGES.action(after, seen))
        self.state = after
        self.X_WE = RigidTransform(after.R_WR, after.p_WR)
        self.q, _ = solve_ik(ARM, self.q, self.X_WE)
        if after.stage == Stage.PUSH:
            ahead = float((after.p_WR - self.p_WK) @ seen.d_W)
            self.p_WK = self.p_WK + max(ahead, 0.0) * seen.d_W
        return taken

    def run(self, last: Stage, limit: int = 150) -> list[Step]:
        """Steps until a stage is entered."""
        steps: list[Step] = []
        while self.state.stage != last:
            assert len(steps) < limit, f"stuck in {self.state.stage.name}"
            steps.append(self.step())
        return steps


def reset_by(forward: float, left: float) -> Change:
    """Makes the planner want a retreat in its next step."""
    return lambda _, seen: replace(seen, reset_offset=np.array([forward, left]))


def missed_by(left: float) -> Change:
    """Moves the contact sideways under the planner."""

    def change(_: PlanState, seen: PushObservation) -> PushObservation:
        beside = np.array([-seen.d_W[1], seen.d_W[0], 0.0])
        return replace(seen, p_WK=seen.p_WK - left * beside)

    return change
