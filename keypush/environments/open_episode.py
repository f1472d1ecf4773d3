"""OpenEpisode: an episode that goes on by one policy step at a time, driven from outside."""

from functools import partial
from typing import Any, override

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform

from diagrams.open_push_diagram import MakeOpenPushDiagram, OpenPushDiagram
from keypush.learning.hand import hand_state
from keypush.objects.point_cloud import pose_to_vector
from keypush.rollout.simulation import EpisodeSimulation
from keypush.rollout.start import EpisodeStart
from keypush.scenario import Scenario
from keypush.systems.episode_monitor import Outcome

Array = NDArray[np.float64]


class OpenEpisode(EpisodeSimulation[OpenPushDiagram]):
    """Stops at every policy step, before its updates.

    What is seen there is what the policies of `MakePushDiagram` see in the updates that follow,
    and the action that the port then gets is the one that acts in them: the action decided on
    seeing step k acts during step k. A `KeypointPredictor` answers one step later, since planner
    and predictor update at the same instant.
    """

    def __init__(self, scenario: Scenario, port: str, meshcat: Meshcat | None = None) -> None:
        """Args: all constants; the port that is driven; where to show it."""
        self._port = port
        self._steps = 0
        super().__init__(scenario, partial(MakeOpenPushDiagram, port=port, meshcat=meshcat))

    @property
    def steps(self) -> int:
        """Policy steps since the start."""
        return self._steps

    @override
    def reset(self, episode: int) -> EpisodeStart:
        """See `EpisodeSimulation.reset`."""
        self._steps = 0
        return super().reset(episode)

    def advance(self, action: Array) -> None:
        """Simulates one policy step.

        Args:
            action: for the port.

        Raises:
            RuntimeError: the simulation failed.
        """
        self.push.diagram.GetInputPort(self._port).FixValue(self._context, action)
        self._steps += 1
        # The same product as Drake's for the time of an event: one ulp more would be a step.
        self._simulator.AdvanceTo(self._steps * self.scenario.episode.policy_period)

    def outcome(self) -> Outcome:
        """Returns how the episode has ended, or that it runs."""
        monitor = self.push.monitor
        return monitor.foresee(monitor.GetMyContextFromRoot(self._context))

    def distance(self) -> float:
        """Returns the distance of the object's origin to the goal in xy, m."""
        return float(np.hypot(*(self._pose("object_pose").translation()[:2] - self._goal())))

    def observe(self, name: str) -> Array:
        """Returns what an observation's name stands for, in full precision."""
        match name:
            case "point_cloud":
                return self._vector("point_cloud").reshape(-1, 3)
            case "com":
                return self._vector("object_com")
            case "goal":
                return self._goal()
            case "hand_state":
                return hand_state(self._pose("tool_pose").GetAsMatrix34())
            case "state":
                return self._vector("arm_state")
            case _:
                return pose_to_vector(self._pose(name))

    def show(self) -> None:
        """Draws the scene as it is."""
        visualizer = self.push.visualizer
        assert visualizer is not None
        visualizer.ForcedPublish(visualizer.GetMyContextFromRoot(self._context))

    def _goal(self) -> Array:
        goal = self.push.goal
        return np.array(goal.get_source_value(goal.GetMyContextFromRoot(self._context)).value())

    def _vector(self, port: str) -> Array:
        return np.array(self._value(port))

    def _pose(self, port: str) -> RigidTransform:
        return RigidTransform(self._value(port))  # a copy: Drake hands out its own cache

    def _value(self, port: str) -> Any:
        station = self.push.station.diagram
        return station.GetOutputPort(port).Eval(station.GetMyContextFromRoot(self._context))
