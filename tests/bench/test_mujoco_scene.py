"""The scene in MuJoCo is the scene in Drake."""

import dataclasses
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull, Delaunay

from diagrams.station import MakePushStation
from keypush.bench.convex_pieces import convex_pieces
from keypush.bench.development_package import import_development
from keypush.bench.mujoco_scene import OBJECT, TOOL, make_mujoco_model
from keypush.control.arm_kinematics import ArmKinematics
from keypush.objects.library import make_object
from keypush.objects.model import ObjectModel
from keypush.scenario import ObjectConfig, Scenario
from tests.objects.every_object import FEW_OBJECTS

mujoco: Any = import_development("mujoco")


@FEW_OBJECTS
def test_pieces_cover_the_object_and_little_else(name: str) -> None:
    mesh = make_object(name).mesh
    pieces = convex_pieces(make_object(name))
    points, _ = trimesh.sample.sample_surface(mesh, 500, seed=0)
    inside = np.zeros(len(points), dtype=bool)
    for piece in pieces:
        centre = piece.mean(axis=0)
        inside |= Delaunay(centre + 1.001 * (piece - centre)).find_simplex(points) >= 0
    assert inside.all()
    volume = sum(ConvexHull(piece).volume for piece in pieces)
    # Flat pieces of a hollow wall are thicker than the wall in their middle.
    assert mesh.volume * 0.999 < volume < mesh.volume * 1.25


@FEW_OBJECTS
def test_an_object_stands_on_its_pieces(name: str) -> None:
    """At the height of its mesh and upright: no piece reaches below the feet, none is short."""
    shape = make_object(name)
    model = make_mujoco_model(Scenario(), shape)
    data = mujoco.MjData(model)
    lowest = min(piece[:, 2].min() for piece in convex_pieces(shape))
    assert lowest == pytest.approx(-shape.rest_height, abs=1e-4)
    body = data.body(OBJECT)
    for _ in range(20):
        mujoco.mj_step(model, data, 50)
        assert np.arccos(min(1.0, body.xmat[8])) < 0.005
    assert data.time == pytest.approx(2.0)
    np.testing.assert_allclose(body.xpos, [0.0, 0.0, shape.rest_height], atol=1e-4)


def test_a_box_is_one_piece_and_a_u_is_a_few() -> None:
    box = trimesh.creation.box((0.06, 0.04, 0.08))
    sides = [trimesh.creation.box((0.02, 0.04, 0.06)) for _ in range(2)]
    bottom = trimesh.creation.box((0.08, 0.04, 0.02))
    for side, x in zip(sides, (-0.03, 0.03), strict=True):
        side.apply_translation((x, 0.0, 0.03))
    bent = trimesh.boolean.union([*sides, bottom], engine="manifold")
    assert len(convex_pieces(_model_of(box))) == 1
    pieces = convex_pieces(_model_of(bent))
    assert len(pieces) in (3, 4)
    volume = sum(ConvexHull(piece).volume for piece in pieces)
    assert volume == pytest.approx(bent.volume, rel=0.01)


def _model_of(mesh: trimesh.Trimesh) -> ObjectModel:
    return dataclasses.replace(make_object("block"), mesh=mesh)


@pytest.mark.parametrize("name", ["mug", "ring"])
def test_pieces_leave_the_inside_of_a_hollow_object_empty(name: str) -> None:
    """Half-way up, on the axis of the round part."""
    model = make_object(name)
    high = model.vertices[model.vertices[:, 2] > model.vertices[:, 2].max() - 1e-3]
    axis = np.array([*(high.min(axis=0) + high.max(axis=0))[:2] / 2, 0.0])
    inside = [Delaunay(piece).find_simplex(axis) >= 0 for piece in convex_pieces(model)]
    assert not any(inside)


def test_pieces_are_the_same_in_every_process() -> None:
    code = (
        "from keypush.bench.convex_pieces import convex_pieces;"
        "from keypush.objects.library import make_object;"
        "print([piece.tolist() for piece in convex_pieces(make_object('tripod'))])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == str(
        [piece.tolist() for piece in convex_pieces(make_object("tripod"))]
    )


def test_pieces_that_are_changed_do_not_change_those_of_the_next_call() -> None:
    first = convex_pieces(make_object("l_block"))
    kept = [piece.copy() for piece in first]
    for piece in first:
        piece[:] = 0.0
    for piece, expected in zip(convex_pieces(make_object("l_block")), kept, strict=True):
        np.testing.assert_array_equal(piece, expected)


def test_kinematics_agree() -> None:
    scenario = Scenario()
    model = make_mujoco_model(scenario, make_object("block"))
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


@pytest.mark.parametrize("name", ["block", "mug"])
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
    model = make_mujoco_model(Scenario(), make_object("block"))
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
