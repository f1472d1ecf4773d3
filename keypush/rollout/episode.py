"""EpisodeRunner: runs episodes of one scenario in one diagram, reset between them."""

import gc
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context
from pydrake.systems.primitives import VectorLog

from diagrams.push_diagram import MakePushDiagram, PushDiagram
from keypush.objects.variation import ObjectVariation, VariedObject, draw_variation, vary_object
from keypush.rollout.apply_variation import set_frictions, set_mass_properties
from keypush.rollout.start import EpisodeStart, StartSampler
from keypush.scenario import POLICIES, Scenario, SimulationConfig
from keypush.systems.episode_logger import ROW_COLUMNS
from keypush.systems.episode_monitor import Outcome, longest_episode
from keypush.systems.episode_seed import set_episode_seed

if TYPE_CHECKING:
    from keypush.learning.predict import KeypointModel


@dataclass(frozen=True)
class EpisodeResult:
    """What an episode leaves behind."""

    summary: dict[str, object]
    """One row of the `episodes` table."""
    rows: dict[str, NDArray[np.generic]]
    """Columns of the `rows` table: (n,) or (n, k), one entry per policy step."""
    seconds: float
    """Simulated time."""


class EpisodeRunner:
    """Builds the diagram and runs any number of episodes in it.

    An episode's result depends on the scenario and its number alone, not on the episodes
    that ran before it. Where the scenario varies the object's size, `push` is another diagram
    after every reset.
    """

    def __init__(self, scenario: Scenario, meshcat: Meshcat | None = None) -> None:
        """Builds the diagram.

        Raises:
            UserError: unknown object, missing weights, a field out of range.
        """
        scenario.validate()
        self.scenario = scenario
        self._keypoint_model = make_keypoint_model(scenario)
        self._meshcat = meshcat
        self._build(scenario.object.size_ratio)

    def run(self, episode: int) -> EpisodeResult:
        """Runs one episode from its start to its end.

        Raises:
            UserError: no start keeps the scenario's distances.
            RuntimeError: the simulation failed.
        """
        self.reset(episode)
        self._simulator.AdvanceTo(longest_episode(self.scenario.episode))
        return self._result(episode)

    def reset(self, episode: int) -> EpisodeStart:
        """Puts the diagram at the start of an episode and initialises the simulator."""
        variation = draw_variation(self.scenario, episode)
        if variation.size_ratio != self.push.station.model.size_ratio:
            self._rebuild(variation.size_ratio)
        start = self._sampler.sample(episode)
        self._redrawn = start.redrawn
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
        self._seed(context, episode)
        self.push.log.FindMutableLog(context).Clear()
        # A fresh integrator: the old one would start with the step size it ended with.
        ApplySimulatorConfig(simulator_config(self.scenario.simulation), self._simulator)
        self._simulator.Initialize()
        return start

    def _build(self, size_ratio: float) -> None:
        resized = replace(self.scenario.object, size_ratio=size_ratio)
        scenario = replace(self.scenario, object=resized)
        self.push: PushDiagram = MakePushDiagram(scenario, self._keypoint_model, self._meshcat)
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

    def _seed(self, context: Context, episode: int) -> None:
        station = self.push.station
        seeded = [station.point_cloud_sensor, station.torque_noise]
        if self.scenario.policy == "expert":
            seeded.append(self.push.planner)
        for system in seeded:
            mine = system.GetMyMutableContextFromRoot(context)
            set_episode_seed(mine, self.scenario.seed, episode)

    def _result(self, episode: int) -> EpisodeResult:
        context = self._context
        monitor = self.push.monitor
        port = monitor.GetOutputPort("verdict")
        verdict = cast("NDArray[np.float64]", port.Eval(monitor.GetMyContextFromRoot(context)))
        outcome = Outcome(int(verdict[0]))
        scenario = self.scenario
        keys = {
            "object": scenario.object.name,
            "size_ratio": self._variation.size_ratio,
            "seed": scenario.seed,
            "episode": episode,
        }
        summary: dict[str, object] = {
            **keys,
            "policy": scenario.policy,
            "success": outcome == Outcome.SUCCESS,
            "settled_success": bool(verdict[2] > 0.5),
            "outcome": outcome.name.lower(),
            "steps": int(verdict[1]),
            "final_position": np.array(self._object_position(context)),
            "mass": self._object.model.mass,
            "object_friction": self._variation.object_friction,
            "table_friction": self._variation.table_friction,
            "gripper_friction": self._variation.gripper_friction,
            "com_offset": self._object.com_offset,
            "com_capped": self._object.com_capped,
            "redrawn": self._redrawn,
        }
        rows = split_rows(self.push.log.FindLog(context), keys)
        return EpisodeResult(summary, rows, context.get_time())

    def _object_position(self, context: Context) -> NDArray[np.float64]:
        station = self.push.station
        plant_context = station.plant.GetMyContextFromRoot(context)
        X_WO = station.plant.EvalBodyPoseInWorld(plant_context, station.object_body)
        return np.asarray(X_WO.translation())


def split_rows(log: VectorLog, keys: Mapping[str, object]) -> dict[str, NDArray[np.generic]]:
    """Splits what the episode's log holds into the columns of the `rows` table.

    Args:
        log: samples of `EpisodeLogger`'s port.
        keys: object, size_ratio, seed and episode, which every row repeats.
    """
    data = log.data().T
    count = len(data)
    rows: dict[str, NDArray[np.generic]] = {
        "object": np.full(count, keys["object"]),
        "size_ratio": np.full(count, keys["size_ratio"], dtype=np.float64),
        "seed": np.full(count, keys["seed"], dtype=np.int64),
        "episode": np.full(count, keys["episode"], dtype=np.int32),
        "step": np.arange(count, dtype=np.int32),
        "time": np.array(log.sample_times()),
    }
    column = 0
    for name, size in ROW_COLUMNS.items():
        block = np.ascontiguousarray(data[:, column : column + size])
        rows[name] = block[:, 0].astype(np.int8) if name == "stage" else block
        column += size
    return rows


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


def make_keypoint_model(scenario: Scenario) -> "KeypointModel | None":
    """Returns the model of the scenario's policy; None for the expert, which needs none.

    Raises:
        UserError: the weights cannot be read.
    """
    if scenario.policy == "expert":
        return None
    # Imported here because torch takes seconds to import and the expert needs none of it.
    from keypush.learning.predict import CentroidKeypoint, load_keypoint_model

    assert scenario.policy in POLICIES
    if scenario.policy == "centroid":
        return CentroidKeypoint()
    return load_keypoint_model(scenario.predictor.weights)
