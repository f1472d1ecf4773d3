"""A planner and the controller with an arm that is always exactly at its target."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import BasicVector, Context, DiagramBuilder, LeafSystem

from keypush.planning.plan_state import Stage
from keypush.systems.differential_ik_controller import DifferentialIkController
from keypush.systems.expert_planner import ExpertPlanner
from keypush.systems.push_planner import PushPlanner
from tests.control.arm import ARM, CONTROL, READY
from tests.systems.contract import evaluate

PERIOD = 0.1


class ExactArm(LeafSystem):
    """Positions are the desired ones, at once."""

    def __init__(self) -> None:
        super().__init__()
        self._desired = self.DeclareVectorInputPort("arm_desired_state", 14)
        self.DeclareVectorOutputPort("arm_state", 14, self._calc_state)
        self.DeclareAbstractOutputPort(
            "tool_pose", lambda: Value(RigidTransform()), self._calc_tool_pose
        )

    def _q(self, context: Any) -> NDArray[np.float64]:
        return np.asarray(self._desired.Eval(context))[:7]

    def _calc_state(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(np.concatenate([self._q(context), np.zeros(7)]))

    def _calc_tool_pose(self, context: Any, output: Any) -> None:
        output.set_value(ARM.tool_pose(self._q(context)))


@dataclass
class ClosedLoop:
    """Planner, controller and arm; the planner's other inputs are fixed values."""

    planner: ExpertPlanner | PushPlanner
    inputs: dict[str, Any]

    def __post_init__(self) -> None:
        builder = DiagramBuilder()
        builder.AddSystem(self.planner)
        controller = builder.AddSystem(DifferentialIkController(ARM, CONTROL, PERIOD))
        arm = builder.AddSystem(ExactArm())
        for source, sink, names in (
            (self.planner, controller, ["tool_action"]),
            (controller, arm, ["arm_desired_state"]),
            (arm, controller, ["arm_state"]),
            (arm, self.planner, ["arm_state", "tool_pose"]),
        ):
            for name in names:
                builder.Connect(source.GetOutputPort(name), sink.GetInputPort(name))
        self.simulator = Simulator(builder.Build())
        root = self.simulator.get_mutable_context()
        self.context = self.planner.GetMyMutableContextFromRoot(root)
        self._arm, self._arm_context = arm, arm.GetMyContextFromRoot(root)
        for name, value in {"halted": [0.0], **self.inputs}.items():
            self.fix(name, value)
        # The arm has no state of its own: it starts where the controller's target is.
        target = controller.GetMyMutableContextFromRoot(root)
        target.get_mutable_discrete_state_vector().SetFromVector(READY)
        self.simulator.Initialize()

    def fix(self, name: str, value: Any) -> None:
        """Sets one of the planner's inputs."""
        self.planner.GetInputPort(name).FixValue(self.context, value)

    def output(self, name: str) -> NDArray[np.float64]:
        return np.array(evaluate(self.planner, name, self.context))

    @property
    def stage(self) -> Stage:
        return Stage(int(self.output("stage")[0]))

    @property
    def tool_pose(self) -> RigidTransform:
        pose: RigidTransform = evaluate(self._arm, "tool_pose", self._arm_context)
        return pose

    def run_until(self, stage: Stage, limit: int = 150) -> int:
        """Advances in policy steps until a stage is entered; returns the steps taken."""
        time = self.simulator.get_context().get_time()
        first = round(time / PERIOD - 0.5)
        for k in range(first + 1, first + limit):
            self.simulator.AdvanceTo((k + 0.5) * PERIOD)
            if self.stage == stage:
                return k - first
        raise AssertionError(f"stuck in {self.stage.name}")
