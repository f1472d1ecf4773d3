"""EpisodeSimulation: a diagram and its simulator, put at the start of any episode."""

import gc
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context, Diagram
from pydrake.systems.primitives import ConstantVectorSource

from diagrams.station import PushStation
from keypush.objects.variation import ObjectVariation, VariedObject, draw_variation, vary_object
from keypush.rollout.apply_variation import set_frictions, set_mass_properties
from keypush.rollout.start import EpisodeStart, StartSampler
from keypush.scenario import Scenario, SimulationConfig
from keypush.systems.episode_seed import set_episode_seed


class StationDiagram(Protocol):
    """A diagram that holds a station and a goal, whoever drives the tool."""

    @property
    def diagram(self) -> Diagram:
        """The whole."""

    @property
    def station(self) -> PushStation:
        """Arm, table, object, sensors and controller."""

    @property
    def goal(self) -> ConstantVectorSource:
        """Goal xy in W, m."""


class EpisodeSimulation[D: StationDiagram]:
    """Builds a diagram and puts it at the start of any number of episodes.

    What a start is depends on the scenario and the episode's number alone, not on what ran
    before it. Where the scenario varies the object's size, `push` is another diagram after
    every reset.
    """

    def __init__(self, scenario: Scenario, make_diagram: Callable[[Scenario], D]) -> None:
        """Builds the diagram.

        Args:
            scenario: all constants, checked.
            make_diagram: makes the diagram of a scenario; called again for another size.

        Raises:
            UserError: unknown object.
        """
        self.scenario = scenario
        self._make_diagram = make_diagram
        self._build(scenario.object.size_ratio)

    def reset(self, episode: int) -> EpisodeStart:
        """Puts the diagram at the start of an episode and initialises the simulator.

        Raises:
            UserError: no start keeps the scenario's distances.
        """
        variation = draw_variation(self.scenario, episode)
        if variation.size_ratio != self.push.station.model.size_ratio:
            self._rebuild(variation.size_ratio)
        start = self._sampler.sample(episode)
        context = self._context
        self.push.diagram.SetDefaultContext(context)
        context.SetTime(0.0)
        self._vary(variation)
        station, plant = self.push.station, self.push.station.plant
        plant_context = plant.GetMyMutableContextFromRoot(context)
        plant.SetPositions(plant_context, station.panda.instance, start.q)
        plant.SetFreeBodyPose(plant_context, station.object_body, start.X_WO)
        goal_context = self.push.goal.GetMyMutableContextFromRoot(context)
        self.push.goal.get_mutable_source_value(goal_context).set_value(start.goal)
        for system in (station.point_cloud_sensor, station.torque_noise):
            mine = system.GetMyMutableContextFromRoot(context)
            set_episode_seed(mine, self.scenario.seed, episode)
        self._prepare(context, episode)
        # A fresh integrator: the old one would start with the step size it ended with.
        ApplySimulatorConfig(simulator_config(self.scenario.simulation), self._simulator)
        self._initialize()
        return start

    def _initialize(self) -> None:
        """A hook: lets the diagram's systems start."""
        self._simulator.Initialize()

    def _prepare(self, context: Context, episode: int) -> None:
        """A hook: sets what a diagram has besides station and goal."""

    def _build(self, size_ratio: float) -> None:
        resized = replace(self.scenario.object, size_ratio=size_ratio)
        scenario = replace(self.scenario, object=resized)
        self.push: D = self._make_diagram(scenario)
        self._sampler = StartSampler(scenario, self.push.station.model)
        self._simulator = Simulator(self.push.diagram)
        self._context = self._simulator.get_mutable_context()

    def _rebuild(self, size_ratio: float) -> None:
        del self.push, self._sampler, self._simulator, self._context
        gc.collect()  # Python does not see how much memory a diagram holds.
        self._build(size_ratio)

    def _vary(self, variation: ObjectVariation) -> None:
        """Puts into the context what differs from its defaults."""
        station, margin = self.push.station, self.scenario.variation.com_margin
        self._variation: ObjectVariation = variation
        self._object: VariedObject = vary_object(station.model, variation, margin)
        set_mass_properties(station, self._context, self._object.model)
        set_frictions(station, self._context, variation, self.scenario)


def simulator_config(config: SimulationConfig) -> SimulatorConfig:
    """Returns Drake's simulator configuration for the scenario's integrator."""
    if config.integrator == "discrete":
        return SimulatorConfig()
    return SimulatorConfig(
        integration_scheme="cenic",
        max_step_size=config.max_step,
        accuracy=config.accuracy,
        use_error_control=True,
    )
