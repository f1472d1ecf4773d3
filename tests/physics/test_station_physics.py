"""The whole station at the shipped setting: long steps against the 1 ms discrete model."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator

from diagrams.station import MakePushStation
from keypush.objects.library import make_object
from keypush.rollout.simulation import simulator_config
from keypush.scenario import EpisodeConfig, NoiseConfig, Scenario, SimulationConfig
from tests.systems.contract import evaluate

Array = NDArray[np.float64]
READY = np.array([0.0, 0.04, 0.0, -2.1, 0.0, 2.1, 0.0])
"""The tool is 0.3 m above the table."""
PLACE = np.array([0.15, 0.18])


@dataclass
class Run:
    """What happened, every 0.1 s."""

    q: Array
    tilt: Array
    p_WO: Array


def run(
    scenario: Scenario,
    action: Callable[[int], Array],
    duration: float,
    name: str = "block",
    drop: float = 0.0,
) -> Run:
    """Simulates the station with an action for every 0.1 s and the object out of reach.

    With `drop` the object starts that far above the table, tilted by 0.01 rad.
    """
    station = MakePushStation(scenario, make_object(name))
    simulator = Simulator(station.diagram)
    ApplySimulatorConfig(simulator_config(scenario.simulation), simulator)
    context = simulator.get_mutable_context()
    plant_context = station.plant.GetMyMutableContextFromRoot(context)
    station.plant.SetPositions(plant_context, station.panda.instance, READY)
    R_WO = RollPitchYaw(0.01 if drop else 0.0, 0.0, 0.7)
    X_WO = RigidTransform(R_WO, np.array([*PLACE, station.model.rest_height + drop]))
    station.plant.SetFreeBodyPose(plant_context, station.object_body, X_WO)
    port = station.diagram.GetInputPort("tool_action")
    port.FixValue(context, action(0))
    simulator.Initialize()
    q, tilt, p_WO = [], [], []
    for k in range(round(duration / 0.1)):
        port.FixValue(context, action(k))
        simulator.AdvanceTo(0.1 * (k + 1))
        q.append(evaluate(station.diagram, "arm_state", context)[:7])
        X_WO = evaluate(station.diagram, "object_pose", context)
        tilt.append(np.arccos(np.clip(X_WO.rotation().matrix()[2, 2], -1.0, 1.0)))
        p_WO.append(X_WO.translation())
    return Run(np.array(q), np.array(tilt), np.array(p_WO))


def scenario(integrator: str, policy_period: float = 0.1) -> Scenario:
    return Scenario(
        noise=NoiseConfig(torque_deviation=0.0),
        simulation=SimulationConfig(integrator=integrator),
        episode=EpisodeConfig(policy_period=policy_period),
    )


def wave(k: int) -> Array:
    """An action that never lets the arm rest."""
    c, s = np.cos(0.5 * k), np.sin(0.5 * k)
    return np.array([0.0, 0.05 * c, 0.03 * s, 0.0, 0.0, 0.05 * c])


@pytest.mark.parametrize(
    ("integrator", "name", "duration"),
    [("cenic", "block", 5.0), ("cenic", "candle", 5.0), ("discrete", "block", 2.0)],
)
def test_an_object_rests_while_the_arm_moves_elsewhere(
    integrator: str, name: str, duration: float
) -> None:
    """The arm's motion chooses the step, and the object must not be moved by it."""
    result = run(scenario(integrator), wave, duration, name)
    assert np.ptp(result.q, axis=0).max() > 0.1
    assert result.tilt.max() < 1e-3
    assert np.abs(result.p_WO[:, :2] - PLACE).max() < 1e-5


@pytest.mark.parametrize("name", ["block", "candle"])
def test_an_object_dropped_by_1_mm_comes_to_rest_while_the_arm_moves(name: str) -> None:
    result = run(scenario("cenic"), wave, 3.0, name, drop=0.001)
    assert result.tilt.max() < 0.011
    assert result.tilt[-1] < 1e-4
    assert np.abs(result.p_WO[:, :2] - PLACE).max() < 5e-4
    assert np.ptp(result.p_WO[10:, 2]) < 1e-6


AXES = pytest.mark.parametrize(("axis", "size"), [(0, 0.06), (1, 0.06), (2, 0.06), (5, 0.1)])


@AXES
def test_the_arm_steps_to_a_held_target_as_in_1_ms_steps(axis: int, size: float) -> None:
    """Within 0.02 rad on the way and 0.01 rad from 0.5 s on, of a way of 0.09 to 0.18 rad."""
    action = size * np.eye(6)[axis]
    cenic, discrete = (
        run(scenario(integrator, policy_period=1.0), lambda _: action, 1.0).q
        for integrator in ("cenic", "discrete")
    )
    error = np.abs(cenic - discrete).max(axis=1)
    assert np.abs(discrete[-1] - READY).max() > 0.05
    assert error.max() < 0.02
    assert error[4:].max() < 0.01


@AXES
def test_the_arm_answers_one_action_as_in_1_ms_steps(axis: int, size: float) -> None:
    """Within 0.025 rad: the next, empty action keeps what the long step made of the first."""

    def action(k: int) -> Array:
        return size * np.eye(6)[axis] if k == 1 else np.zeros(6)

    cenic, discrete = (
        run(scenario(integrator), action, 0.8).q for integrator in ("cenic", "discrete")
    )
    assert np.abs(discrete[-1] - READY).max() > 0.05
    assert np.abs(cenic - discrete).max() < 0.025
