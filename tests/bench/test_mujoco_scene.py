"""The scene in MuJoCo is the scene in Drake."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from diagrams.station import MakePushStation
from keypush.bench.convex_pieces import convex_pieces
from keypush.bench.mujoco_scene import TOOL, import_mujoco, make_mujoco_model
from keypush.control.arm_kinematics import ArmKinematics
from keypush.errors import UserError
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import make_object
from keypush.scenario import ObjectConfig, Scenario

mujoco: Any = import_mujoco()


@pytest.mark.parametrize("name", catalogue_names())
def test_pieces_cover_the_object_and_little_else(name: str) -> None:
    model = make_object(name)
    pieces = convex_pieces(model)
    points = model.surface_points(500, np.random.default_rng(0))
    inside = np.zeros(len(points), dtype=bool)
    for piece in pieces:
        centre = piece.mean(axis=0)
        inside |= Delaunay(centre + 1.001 * (piece - centre)).find_simplex(points) >= 0
    assert inside.all()
    volume = sum(ConvexHull(piece).volume for piece in pieces)
    # Flat pieces of a hollow wall are thicker than the wall in their middle.
    assert model.mesh.volume * 0.999 < volume < model.mesh.volume * 1.25


def test_pieces_of_the_mug_leave_its_inside_empty() -> None:
    model = make_object("mug")
    axis = np.array([model.vertices[-10, 0], 0.0, 0.0])  # The centre of its base, at mid-height.
    inside = [Delaunay(piece).find_simplex(axis) >= 0 for piece in convex_pieces(model)]
    assert not any(inside)


def test_a_shape_without_pieces_is_refused() -> None:
    bent = make_object("l_block")
    object.__setattr__(bent, "name", "boomerang")
    with pytest.raises(UserError, match="'boomerang' has no convex pieces"):
        convex_pieces(bent)


def test_kinematics_agree() -> None:
    scenario = Scenario()
    model = make_mujoco_model(scenario, make_object("box"))
    data = mujoco.MjData(model)
    arm = ArmKinematics(scenario.robot)
    rng = np.random.default_rng(0)
    for _ in range(50):
        q = rng.uniform(arm.limits.lower, arm.limits.upper)
        data.qpos[:7] = q
        mujoco.mj_kinematics(model, data)
        X_WE = arm.tool_pose(q)
        np.testing.assert_allclose(data.site(TOOL).xpos, X_WE.translation(), atol=1e-6)
        R_WE = data.site(TOOL).xmat.reshape(3, 3)
        np.testing.assert_allclose(R_WE, X_WE.rotation().matrix(), atol=1e-6)
    np.testing.assert_allclose(model.jnt_range[:7], np.c_[arm.limits.lower, arm.limits.upper])


@pytest.mark.parametrize("name", ["box", "mug"])
def test_inertia_agrees(name: str) -> None:
    """The mass matrix at random positions, with reflected inertia; mug: COM off its origin."""
    scenario = Scenario(policy="expert", object=ObjectConfig(name=name))
    shape = make_object(name)
    plant = MakePushStation(scenario, shape).plant
    context = plant.CreateDefaultContext()
    model = make_mujoco_model(scenario, shape)
    data = mujoco.MjData(model)
    mass = plant.CalcTotalMass(context)
    assert model.body_mass.sum() == pytest.approx(mass, rel=1e-12)
    rng = np.random.default_rng(1)
    for _ in range(5):
        q = rng.uniform(model.jnt_range[:7, 0], model.jnt_range[:7, 1])
        plant.SetPositions(context, plant.GetModelInstanceByName("panda"), q)
        data.qpos[:7] = q
        mujoco.mj_forward(model, data)
        ours = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, ours)
        theirs = plant.CalcMassMatrix(context)[:7, :7]
        np.testing.assert_allclose(ours[:7, :7], theirs, rtol=1e-6, atol=1e-6)
    body = model.body("object")
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, body.iquat)
    I_O = R.reshape(3, 3) @ np.diag(body.inertia) @ R.reshape(3, 3).T
    np.testing.assert_allclose(I_O, shape.I_OOcm_O, atol=1e-10)
    np.testing.assert_allclose(body.ipos, shape.p_OoOcm_O, atol=1e-12)


def test_friction_is_combined_as_in_drake() -> None:
    model = make_mujoco_model(Scenario(), make_object("box"))
    pairs = {
        frozenset((model.geom(a).name, model.geom(b).name)): friction[0]
        for a, b, friction in zip(
            model.pair_geom1, model.pair_geom2, model.pair_friction, strict=True
        )
    }
    assert pairs[frozenset(("object_0", "table_top"))] == pytest.approx(2 * 0.7 * 0.4 / 1.1)
    assert pairs[frozenset(("object_0", "fingers"))] == pytest.approx(2 * 0.7 * 1.0 / 1.7)
    assert pairs[frozenset(("palm", "table_top"))] == pytest.approx(2 * 1.0 * 0.4 / 1.4)
    assert frozenset(("palm", "fingers")) not in pairs
