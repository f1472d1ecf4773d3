"""StationPoses: the right bodies' poses, and the centre of mass in W."""

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import Context

from keypush.systems.station_poses import StationPoses
from tests.systems.contract import assert_pure, assert_resets, evaluate, ports

P_OCM = np.array([0.01, -0.02, 0.005])
X_HE = RigidTransform(RollPitchYaw(0.1, 0.0, -0.7), np.array([0.0, 0.0, 0.1034]))
X_WO = RigidTransform(RollPitchYaw(0.3, 0.2, 0.1), np.array([0.1, 0.2, 0.3]))
X_WH = RigidTransform(RollPitchYaw(3.0, 0.1, -1.0), np.array([-0.1, 0.0, 0.5]))


def _poses() -> tuple[StationPoses, Context]:
    system = StationPoses(BodyIndex(2), BodyIndex(1), X_HE, P_OCM)
    context = system.CreateDefaultContext()
    bodies = Value[list[RigidTransform]]([RigidTransform(), X_WH, X_WO, RigidTransform()])
    system.GetInputPort("body_poses").FixValue(context, bodies)
    return system, context


def test_ports() -> None:
    assert ports(_poses()[0]) == {
        "in": {"body_poses": None},
        "out": {"object_pose": None, "object_com": 3, "tool_pose": None},
    }


def test_outputs_are_pure_and_the_context_resets() -> None:
    system, context = _poses()
    system.set_com(context, P_OCM + 0.01)
    assert_pure(system, context)
    assert_resets(system, context)


def test_object_and_tool_are_the_right_bodies() -> None:
    system, context = _poses()
    assert evaluate(system, "object_pose", context).IsExactlyEqualTo(X_WO)
    X_WE = evaluate(system, "tool_pose", context)
    assert X_WE.IsNearlyEqualTo(X_WH @ X_HE, 1e-15)


def test_the_centre_of_mass_is_the_contexts_own() -> None:
    system, context = _poses()
    other = context.Clone()
    moved = np.array([0.0, 0.015, 0.0])
    system.set_com(other, moved)
    np.testing.assert_allclose(evaluate(system, "object_com", other), X_WO @ moved)
    np.testing.assert_allclose(evaluate(system, "object_com", context), X_WO @ P_OCM)
