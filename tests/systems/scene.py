"""A system that asks a model about the scene, alone, its inputs fixed."""

from typing import override

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context

from keypush.learning.model import KeypointModel
from keypush.systems.scene_system import SceneSystem
from tests.systems.contract import assert_pure, assert_resets

PERIOD, POINTS = 0.1, 16
GOAL, COM = np.array([0.1, -0.05]), np.array([0.01, 0.02, 0.03])
X_WE = RigidTransform(RollPitchYaw(3.0, 0.2, -1.0), np.array([0.1, 0.2, 0.3]))
Vector = NDArray[np.floating]


class SpyModel(KeypointModel):
    """Remembers what it was asked, and how often; what it answers is another's."""

    def __init__(self) -> None:
        self.calls: list[tuple[Vector, Vector, Vector | None, Vector]] = []

    @property
    @override
    def uses_com(self) -> bool:
        return True

    @override
    def predict(
        self, cloud_W: Vector, goal_W: Vector, com_W: Vector | None, hand: Vector
    ) -> NDArray[np.float64]:
        com = None if com_W is None else com_W.copy()
        self.calls.append((cloud_W.copy(), goal_W.copy(), com, hand.copy()))
        return self.answer(cloud_W)

    def answer(self, cloud_W: Vector) -> NDArray[np.float64]:
        raise NotImplementedError


class SceneBench:
    """The system and its simulator."""

    def __init__(
        self,
        model: SpyModel,
        system: SceneSystem,
        cloud: NDArray[np.float64],
        com: NDArray[np.float64] | None = COM,
    ) -> None:
        self.model, self.system = model, system
        self.simulator = Simulator(system)
        self.context: Context = self.simulator.get_mutable_context()
        self.see(cloud)
        self.fix("goal", GOAL)
        self.fix("tool_pose", X_WE)
        if com is not None:
            self.fix("object_com", com)

    def fix(self, port: str, value: object) -> None:
        self.system.GetInputPort(port).FixValue(self.context, value)

    def see(self, cloud: NDArray[np.float64]) -> None:
        self.fix("point_cloud", cloud.ravel())

    def output(self, name: str) -> NDArray[np.float64]:
        return np.array(self.system.GetOutputPort(name).Eval(self.context))


def check_purity_and_reset(scene: SceneBench) -> None:
    scene.simulator.AdvanceTo(0.25)
    asked = len(scene.model.calls)
    assert_pure(scene.system, scene.context)
    assert len(scene.model.calls) == asked
    assert_resets(scene.system, scene.context)


def check_what_the_model_sees(scene: SceneBench, expected: NDArray[np.float64]) -> None:
    scene.simulator.Initialize()
    cloud, goal, com, hand = scene.model.calls[0]
    R_WE = X_WE.rotation().matrix()
    np.testing.assert_array_equal(cloud, expected)
    np.testing.assert_array_equal(goal, GOAL)
    np.testing.assert_array_equal(com, COM)
    np.testing.assert_array_equal(hand, [*X_WE.translation(), *R_WE[:, 0], *R_WE[:, 1]])
