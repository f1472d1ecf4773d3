"""The station: its ports, what depends on what, and a tool that obeys."""

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator

from diagrams.station import MakePushStation, PushStation
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import make_object
from keypush.rollout.simulation import simulator_config
from keypush.scenario import NoiseConfig, Scenario, SimulationConfig, parse_scenario
from tests.physics.exact_shapes import exact_model
from tests.systems.contract import evaluate, ports

READY = np.array([0.0, 0.04, 0.0, -2.1, 0.0, 2.1, 0.0])
QUIET = Scenario(noise=NoiseConfig(torque_deviation=0.0))


def _station(scenario: Scenario = QUIET, name: str = "block") -> PushStation:
    return MakePushStation(scenario, make_object(name))


def _simulator(station: PushStation, scenario: Scenario = QUIET) -> Simulator:
    simulator = Simulator(station.diagram)
    ApplySimulatorConfig(simulator_config(scenario.simulation), simulator)
    context = simulator.get_mutable_context()
    plant_context = station.plant.GetMyMutableContextFromRoot(context)
    station.plant.SetPositions(plant_context, station.panda.instance, READY)
    place = RigidTransform(np.array([0.1, 0.1, station.model.rest_height]))
    station.plant.SetFreeBodyPose(plant_context, station.object_body, place)
    station.diagram.GetInputPort("tool_action").FixValue(context, np.zeros(6))
    simulator.Initialize()
    return simulator


def test_ports() -> None:
    points = QUIET.noise.cloud_points
    assert ports(_station().diagram) == {
        "in": {"tool_action": 6},
        "out": {
            "arm_state": 14,
            "tool_pose": None,
            "object_pose": None,
            "object_com": 3,
            "point_cloud": 3 * points,
            "contact": 6,
            "query_object": None,
        },
    }


@pytest.mark.parametrize("integrator", ["cenic", "discrete"])
def test_no_output_depends_on_the_action_at_once(integrator: str) -> None:
    """So that any policy may be wired from the outputs to the action without a loop."""
    diagram = _station(Scenario(simulation=SimulationConfig(integrator=integrator))).diagram
    assert not any(diagram.HasDirectFeedthrough(0, i) for i in range(diagram.num_output_ports()))


@pytest.mark.parametrize("name", catalogue_names())
def test_every_object_of_the_catalogue_has_a_station(name: str) -> None:
    station = _station(name=name)
    names = {system.get_name() for system in station.diagram.GetSystems()}
    assert names == {
        "plant",
        "scene_graph",
        "station_poses",
        "point_cloud_sensor",
        "differential_ik_controller",
        "torque_noise",
        "contact_sensor",
    }
    assert station.plant.num_positions() == 7 + 7


def test_the_outputs_describe_one_world() -> None:
    # On a sharp box, whose surface is where a coordinate is at its limit.
    station = MakePushStation(parse_scenario("noise: {cloud_deviation: 0.0}"), exact_model("box"))
    simulator = _simulator(station)
    context = simulator.get_context()
    X_WO = evaluate(station.diagram, "object_pose", context)
    np.testing.assert_allclose(X_WO.translation(), [0.1, 0.1, station.model.rest_height])
    com = evaluate(station.diagram, "object_com", context)
    np.testing.assert_allclose(com, X_WO @ station.model.p_OoOcm_O)
    cloud = evaluate(station.diagram, "point_cloud", context).reshape(-1, 3)
    p_OP = (cloud - X_WO.translation()) @ X_WO.rotation().matrix()
    half = station.model.visual.bounds[1]
    np.testing.assert_allclose(np.max(np.abs(p_OP) / half, axis=1), 1.0, atol=1e-9)
    arm_state = evaluate(station.diagram, "arm_state", context)
    np.testing.assert_array_equal(arm_state, [*READY, *np.zeros(7)])
    plant_context = station.plant.GetMyContextFromRoot(context)
    X_WE = station.panda.tool_frame.CalcPoseInWorld(plant_context)
    assert evaluate(station.diagram, "tool_pose", context).IsNearlyEqualTo(X_WE, 1e-12)
    assert np.all(np.isnan(evaluate(station.diagram, "contact", context)[:3]))


@pytest.mark.parametrize("integrator", ["cenic", "discrete"])
def test_without_an_action_nothing_moves(integrator: str) -> None:
    scenario = Scenario(
        noise=NoiseConfig(torque_deviation=0.0), simulation=SimulationConfig(integrator=integrator)
    )
    station = _station(scenario)
    simulator = _simulator(station, scenario)
    simulator.AdvanceTo(0.5)
    context = simulator.get_context()
    arm_state = evaluate(station.diagram, "arm_state", context)
    np.testing.assert_allclose(arm_state[:7], READY, atol=1e-6)
    p_WO = evaluate(station.diagram, "object_pose", context).translation()
    np.testing.assert_allclose(p_WO, [0.1, 0.1, station.model.rest_height], atol=5e-4)


@pytest.mark.parametrize("axis", range(3))
def test_the_tool_follows_an_action_along_every_axis(axis: int) -> None:
    station = _station()
    simulator = _simulator(station)
    context = simulator.get_mutable_context()
    before = evaluate(station.diagram, "tool_pose", context)
    action = 0.02 * np.eye(6)[axis]
    station.diagram.GetInputPort("tool_action").FixValue(context, action)
    simulator.AdvanceTo(0.5)
    after = evaluate(station.diagram, "tool_pose", context)
    moved = after.translation() - before.translation()
    assert moved[axis] > 0.01
    assert np.all(np.abs(np.delete(moved, axis)) < 0.5 * moved[axis])


def test_torque_noise_reaches_the_joints() -> None:
    scenario = parse_scenario("noise: {torque_deviation: 1.0}")
    station = _station(scenario)
    simulator = _simulator(station, scenario)
    simulator.AdvanceTo(0.2)
    velocity = evaluate(station.diagram, "arm_state", simulator.get_context())[7:]
    assert np.all(np.abs(velocity) > 1e-5)


def test_the_contact_sensor_knows_hand_wrist_and_object() -> None:
    """A tool put into the object is felt, and pushes it away from itself."""
    station = _station()
    simulator = _simulator(station)
    context = simulator.get_mutable_context()
    X_WE = evaluate(station.diagram, "tool_pose", context)
    plant_context = station.plant.GetMyMutableContextFromRoot(context)
    beside = RigidTransform(X_WE.translation() + np.array([0.0, 0.04, 0.0]))
    station.plant.SetFreeBodyPose(plant_context, station.object_body, beside)
    contact = evaluate(station.diagram, "contact", context)
    assert np.all(np.isfinite(contact))
    assert contact[4] > 0.1
    assert np.linalg.norm(contact[:3] - X_WE.translation()) < 0.05
