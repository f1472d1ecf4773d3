"""EpisodeRunner: runs episodes of one scenario in one diagram, reset between them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import cast, override

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context
from pydrake.systems.primitives import VectorLog

from diagrams.push_diagram import MakePushDiagram, PushDiagram
from keypush.learning.model import PolicyError
from keypush.learning.policy_model import policy_model
from keypush.policies import policy_label
from keypush.rollout.simulation import EpisodeSimulation
from keypush.rollout.start import EpisodeStart
from keypush.scenario import Scenario
from keypush.systems.episode_logger import ROW_COLUMNS
from keypush.systems.episode_monitor import Outcome, longest_episode
from keypush.systems.episode_seed import set_episode_seed


@dataclass(frozen=True)
class EpisodeResult:
    """What an episode leaves behind."""

    summary: dict[str, object]
    """One row of the `episodes` table."""
    rows: dict[str, NDArray[np.generic]]
    """Columns of the `rows` table: (n,) or (n, k), one entry per policy step."""
    seconds: float
    """Simulated time."""


class EpisodeRunner(EpisodeSimulation[PushDiagram]):
    """Builds the diagram and runs any number of episodes in it.

    An episode's result depends on the scenario and its number alone, not on the episodes
    that ran before it. One in which the policy fails ends there, with a row of what was seen then
    and the reason in its summary.
    """

    def __init__(self, scenario: Scenario, meshcat: Meshcat | None = None) -> None:
        """Builds the diagram.

        Raises:
            UserError: unknown object, weights that are missing or do not fit the policy, a field
                out of range.
        """
        scenario.validate()
        model = policy_model(scenario.policy, scenario.predictor.weights)
        make = partial(MakePushDiagram, policy_model=model, meshcat=meshcat)
        super().__init__(scenario, make)

    def run(self, episode: int) -> EpisodeResult:
        """Runs one episode from its start to its end.

        Raises:
            UserError: no start keeps the scenario's distances.
            RuntimeError: the simulation failed.
        """
        self.reset(episode)
        if not self._reason:
            end = longest_episode(self.scenario.episode)
            self._until_failure(lambda: self._simulator.AdvanceTo(end))
        return self._result(episode)

    @override
    def reset(self, episode: int) -> EpisodeStart:
        """Puts the diagram at the start of an episode; see `EpisodeSimulation.reset`."""
        start = super().reset(episode)
        self._redrawn = start.redrawn
        return start

    @override
    def _initialize(self) -> None:
        self._reason = ""
        self._until_failure(super()._initialize)

    def _until_failure(self, advance: Callable[[], object]) -> None:
        """Simulates; where the policy fails, says why and logs the row at which it did."""
        try:
            advance()
        except PolicyError as failure:
            self._reason = str(failure)
            context = self._context
            times = self.push.log.FindLog(context).sample_times()
            if not len(times) or times[-1] < context.get_time():
                self.push.diagram.ForcedPublish(context)

    @override
    def _prepare(self, context: Context, episode: int) -> None:
        if self.scenario.policy == "expert":
            mine = self.push.planner.GetMyMutableContextFromRoot(context)
            set_episode_seed(mine, self.scenario.seed, episode)
        self.push.log.FindMutableLog(context).Clear()

    def _result(self, episode: int) -> EpisodeResult:
        context = self._context
        monitor = self.push.monitor
        port = monitor.GetOutputPort("verdict")
        verdict = cast("NDArray[np.float64]", port.Eval(monitor.GetMyContextFromRoot(context)))
        outcome, steps = Outcome(int(verdict[0])), int(verdict[1])
        settled = bool(verdict[2] > 0.5)
        scenario = self.scenario
        if self._reason:  # also where the goal had been reached before
            outcome, settled = Outcome.POLICY_FAILED, False
            steps = round(context.get_time() / scenario.episode.policy_period)
        keys = {
            "object": scenario.object.name,
            "size_ratio": self._variation.size_ratio,
            "seed": scenario.seed,
            "episode": episode,
        }
        summary: dict[str, object] = {
            **keys,
            "policy": policy_label(scenario.policy),
            "success": outcome == Outcome.SUCCESS,
            "settled_success": settled,
            "outcome": outcome.name.lower(),
            # The expert asks no model that could fail; its episodes become data sets.
            **({} if scenario.policy == "expert" else {"reason": self._reason}),
            "steps": steps,
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
