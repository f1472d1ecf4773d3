"""Episodes with a varied object: what reaches Drake, what is logged, and that nothing stays."""

import gc
import weakref
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.multibody.plant import CoulombFriction
from pydrake.systems.framework import Context, Diagram

from keypush.objects.library import make_object
from keypush.objects.plant import spatial_inertia
from keypush.objects.variation import draw_variation, vary_object
from keypush.rollout.episode import EpisodeResult, EpisodeRunner
from keypush.scenario import Scenario, parse_scenario

STEPS = 4
MASS = {"mass": [0.5, 2.0], "com_shift": 0.015}
FRICTION = {"object_friction": [0.5, 1.5], "table_friction": [0.5, 1.5],
            "gripper_friction": [0.5, 1.5]}  # fmt: skip
SIZE = {"size": [0.75, 1.25]}
ALL = {**MASS, **FRICTION, **SIZE}


class OpenRunner(EpisodeRunner):
    """Shows its context."""

    @property
    def context(self) -> Context:
        return self._context


def _scenario(variation: dict[str, Any], **changes: Any) -> Scenario:
    settings = {
        "policy": "expert",
        "object": {"name": "mug"},
        "episode": {"max_steps": STEPS},
        "variation": variation,
    }
    return parse_scenario(repr({**settings, **changes}))


def _frictions(runner: OpenRunner) -> dict[str, float]:
    """Coefficients in the context, by the geometry's name."""
    station = runner.push.station
    context = station.scene_graph.GetMyContextFromRoot(runner.context)
    query: Any = station.scene_graph.get_query_output_port().Eval(context)
    inspector = query.inspector()
    found = {}
    for geometry in inspector.GetAllGeometryIds():
        properties = inspector.GetProximityProperties(geometry)
        if properties is not None:
            friction: CoulombFriction = properties.GetProperty("material", "coulomb_friction")
            assert friction.static_friction() == friction.dynamic_friction()
            found[inspector.GetName(geometry)] = friction.static_friction()
    return found


def _inertia(runner: OpenRunner) -> NDArray[np.float64]:
    """M_OOo_O in the context, (6, 6)."""
    station = runner.push.station
    context = station.plant.GetMyContextFromRoot(runner.context)
    M_OOo_O = station.object_body.CalcSpatialInertiaInBodyFrame(context)
    return np.asarray(M_OOo_O.CopyToFullMatrix6())


def _com(runner: OpenRunner) -> NDArray[np.float64]:
    """What the port `object_com` says, in O."""
    poses = runner.push.station.poses
    context = poses.GetMyContextFromRoot(runner.context)
    X_WO: Any = poses.GetOutputPort("object_pose").Eval(context)
    return np.asarray(X_WO.inverse() @ poses.GetOutputPort("object_com").Eval(context))


def _bytes(result: EpisodeResult) -> dict[str, bytes]:
    return {
        **{name: column.tobytes() for name, column in result.rows.items()},
        **{name: repr(value).encode() for name, value in result.summary.items()},
    }


@pytest.mark.parametrize("integrator", ["cenic", "discrete"])
@pytest.mark.parametrize("variation", [MASS, FRICTION, SIZE, ALL])
def test_what_is_drawn_reaches_the_context(variation: dict[str, Any], integrator: str) -> None:
    scenario = _scenario(variation, simulation={"integrator": integrator})
    runner = OpenRunner(scenario)
    for episode in (1, 2):
        runner.reset(episode)
        drawn = draw_variation(scenario, episode)
        model = make_object("mug", drawn.size_ratio, scenario.object.mass)
        expected = vary_object(model, drawn, 0.005)
        M_OOo_O = spatial_inertia(expected.model).CopyToFullMatrix6()
        np.testing.assert_allclose(_inertia(runner), M_OOo_O, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(_com(runner), expected.model.p_OoOcm_O, atol=1e-9)
        assert _frictions(runner) == {
            "object::object_collision": drawn.object_friction,
            "table::table_top": drawn.table_friction,
            "table::floor": drawn.table_friction,
            **dict.fromkeys(
                [
                    f"panda::{n}"
                    for n in ("palm", "fingers", "wrist_pitch", "wrist_roll", "forearm")
                ],
                drawn.gripper_friction,
            ),
        }
        found = runner.push.station.model
        np.testing.assert_allclose(found.vertices, model.vertices, atol=1e-12)


@pytest.mark.parametrize("variation", [MASS, FRICTION, SIZE, ALL])
def test_an_episode_does_not_depend_on_those_before_it(variation: dict[str, Any]) -> None:
    scenario = _scenario(variation)
    runner = EpisodeRunner(scenario)
    first = _bytes(runner.run(3))
    assert _bytes(runner.run(5)) != first
    assert _bytes(runner.run(3)) == first
    assert _bytes(EpisodeRunner(scenario).run(3)) == first


def test_a_reset_takes_back_what_the_scenario_no_longer_varies() -> None:
    runner, plain = OpenRunner(_scenario(ALL)), OpenRunner(_scenario({}))
    plain.reset(2)
    runner.reset(2)
    assert _frictions(runner) != _frictions(plain)
    runner.scenario = plain.scenario
    runner.reset(2)
    assert _frictions(runner) == _frictions(plain)
    np.testing.assert_array_equal(_inertia(runner), _inertia(plain))
    np.testing.assert_array_equal(_com(runner), _com(plain))
    assert _bytes(runner.run(2)) == _bytes(plain.run(2))


def test_a_shift_changes_neither_start_nor_goal_nor_noise() -> None:
    plain, shifted = (OpenRunner(_scenario(v)) for v in ({}, {**MASS, **FRICTION}))
    for episode in range(4):
        ours, theirs = shifted.reset(episode), plain.reset(episode)
        np.testing.assert_array_equal(ours.X_WO.GetAsMatrix4(), theirs.X_WO.GetAsMatrix4())
        np.testing.assert_array_equal(ours.goal, theirs.goal)
        np.testing.assert_array_equal(ours.q, theirs.q)
        clouds = []
        for runner in (plain, shifted):
            sensor = runner.push.station.point_cloud_sensor
            port: Any = sensor.GetOutputPort("point_cloud")
            clouds.append(np.array(port.Eval(sensor.GetMyContextFromRoot(runner.context))))
        np.testing.assert_array_equal(clouds[0], clouds[1])


def test_the_log_says_what_the_episode_had() -> None:
    scenario = _scenario(ALL)
    runner = EpisodeRunner(scenario)
    sizes = set()
    for episode in range(3):
        result = runner.run(episode)
        drawn = draw_variation(scenario, episode)
        summary: dict[str, Any] = result.summary
        for name in ("size_ratio", "object_friction", "table_friction", "gripper_friction"):
            assert summary[name] == getattr(drawn, name)
        assert summary["mass"] == 0.1 * drawn.mass_factor
        np.testing.assert_array_equal(result.rows["size_ratio"], drawn.size_ratio)
        model = make_object("mug", drawn.size_ratio)
        expected = model.p_OoOcm_O + np.array([*summary["com_offset"], 0.0])
        pose, com = (np.asarray(result.rows[name][0], float) for name in ("object_pose", "com"))
        yaw = 2 * np.arctan2(pose[3], pose[0])
        c, s = np.cos(yaw), np.sin(yaw)
        R_WO = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        np.testing.assert_allclose(com, R_WO @ expected + pose[4:], atol=1e-6)
        wanted = np.hypot(*summary["com_offset"]) < 0.015 - 1e-9
        assert summary["com_capped"] is bool(wanted)
        sizes.add(drawn.size_ratio)
    assert len(sizes) == 3


def test_without_variation_the_log_says_so() -> None:
    summary: dict[str, Any] = EpisodeRunner(_scenario({})).run(0).summary
    columns = ("size_ratio", "mass", "object_friction", "table_friction", "gripper_friction")
    assert [summary[name] for name in columns] == [1.0, 0.1, 0.7, 0.4, 1.0]
    np.testing.assert_array_equal(summary["com_offset"], [0.0, 0.0])
    assert summary["com_capped"] is False


def test_one_diagram_serves_every_episode_of_one_size() -> None:
    runner = EpisodeRunner(_scenario({**MASS, **FRICTION}))
    diagram = runner.push.diagram
    for episode in range(3):
        runner.reset(episode)
        assert runner.push.diagram is diagram
    resized = EpisodeRunner(_scenario({"size": [0.8, 0.8]}))
    resized.reset(0)
    diagram = resized.push.diagram
    resized.reset(1)
    assert resized.push.diagram is diagram


def test_no_diagram_outlives_its_episode() -> None:
    runner = EpisodeRunner(_scenario(SIZE))
    gone: list[weakref.ref[Diagram]] = []
    for episode in range(3):
        runner.reset(episode)
        assert all(dropped() is None for dropped in gone)
        gone.append(weakref.ref(runner.push.diagram))
    gc.collect()
    assert gone[-1]() is runner.push.diagram


def test_starts_fit_the_episodes_size() -> None:
    runner = EpisodeRunner(_scenario(SIZE))
    for episode in range(4):
        start = runner.reset(episode)
        model = runner.push.station.model
        lowest = (start.X_WO.rotation().matrix() @ model.vertices.T).T[:, 2].min()
        assert start.X_WO.translation()[2] + lowest == pytest.approx(0.0, abs=1e-9)
