"""The tilt that an episode's noisy clouds tell is that of the object."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, EventStatus

from diagrams.push_diagram import MakePushDiagram
from keypush.learning.baselines import GeometricKeypoint
from keypush.rollout.simulation import EpisodeSimulation
from keypush.scenario import parse_scenario
from tests.systems.contract import evaluate

SCENARIO = "{policy: geometric, object: {name: bowl}, variation: {com_shift: 0.015}}"


def _tilts_deg(episode: int) -> NDArray[np.float64]:
    """True and estimated tilt at the end of every policy step, (n, 2)."""
    model = GeometricKeypoint(uses_com=True)
    simulation = EpisodeSimulation(
        parse_scenario(SCENARIO), lambda scenario: MakePushDiagram(scenario, model)
    )
    X_WO = simulation.reset(episode).X_WO
    diagram = simulation.push.diagram
    estimator = diagram.GetSubsystemByName("upright_estimator")
    station = simulation.push.station.diagram
    found = {}

    def look(context: Context) -> EventStatus:
        up = evaluate(estimator, "object_up", estimator.GetMyContextFromRoot(context))
        pose: RigidTransform = evaluate(
            station, "object_pose", station.GetMyContextFromRoot(context)
        )
        cosines = [X_WO.rotation().matrix()[2] @ pose.rotation().matrix()[2], up[2]]
        found[round(context.get_time(), 1)] = np.rad2deg(np.arccos(np.clip(cosines, -1.0, 1.0)))
        return EventStatus.DidNothing()

    simulator = simulation._simulator
    simulator.set_monitor(look)
    simulator.AdvanceTo(12.0)
    return np.array(list(found.values()))


def test_the_estimated_tilt_follows_the_true_one() -> None:
    true, estimated = np.concatenate([_tilts_deg(episode) for episode in range(3)]).T
    assert true.max() > 1.5, "the object hardly tilted"
    still = true < 0.2
    assert np.mean(estimated[still]) < 0.4
    assert np.mean(np.abs(estimated - true)[true > 1.0]) < 0.7
