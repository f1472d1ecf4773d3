"""How an episode starts: object pose, goal and arm, drawn at random."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RollPitchYaw

from keypush.control.arm_kinematics import ArmKinematics
from keypush.errors import UserError
from keypush.objects.model import ObjectModel
from keypush.planning.contact import push_through_com
from keypush.planning.plan_state import PushObservation
from keypush.planning.stages import PushStages
from keypush.robot.hand_shape import PALM
from keypush.scenario import PlannerConfig, Scenario, TableConfig
from keypush.seeding import make_generator

Array = NDArray[np.float64]
_TRIES = 10_000
_REACH_TRIES = 50
_PALM_DISTANCE = 0.01
"""The palm is ten centimetres behind the tool tip, whose distance says little of it, m."""


@dataclass(frozen=True)
class EpisodeStart:
    """Where everything is at time 0; the arm is at rest."""

    X_WO: RigidTransform
    goal: Array
    """(2,) goal xy in W, m."""
    q: Array
    """(7,) arm joint positions, rad."""
    redrawn: int
    """How many starts before this one were dropped because the arm could not make the push."""


class StartSampler:
    """Draws starts; the same (seed, episode) gives the same start."""

    def __init__(self, scenario: Scenario, model: ObjectModel) -> None:
        self._scenario = scenario
        self._model = model
        self._arm = ArmKinematics(scenario.robot)
        # The same for every planner, so that policies face the same episodes.
        period = scenario.episode.policy_period
        self._stages = PushStages(
            self._arm, PlannerConfig(), scenario.control, scenario.table, period
        )

    def sample(self, episode: int) -> EpisodeStart:
        """Draws the start of one episode.

        Starts are drawn until the arm, with the default posture of a push, reaches behind the
        object, above there, and where the push ends.

        Raises:
            UserError: no start keeps the scenario's distances, or the arm reaches none.
        """
        seed = self._scenario.seed
        place = make_generator(seed, episode, "object_and_goal")
        arm = make_generator(seed, episode, "arm")
        for redrawn in range(_REACH_TRIES):
            X_WO, goal = self._object_and_goal(place)
            q = self._arm_positions(arm, X_WO)
            if self._stages.reaches(self._first_sight(X_WO, goal, q)):
                return EpisodeStart(X_WO, goal, q, redrawn)
        raise UserError(
            f"the arm reaches none of {_REACH_TRIES} starts of {self._model.name!r} with "
            f"episode.goal {self._scenario.episode.goal}; allowed: a goal to which it can push"
        )

    def _first_sight(self, X_WO: RigidTransform, goal: Array, q: Array) -> PushObservation:
        """What the expert sees at the start."""
        p_WOcm = X_WO.rotation().matrix() @ self._model.p_OoOcm_O + X_WO.translation()
        p_WK, d_W, distance = push_through_com(self._model.p_OP, X_WO, p_WOcm, goal)
        left = distance - self._scenario.episode.goal_radius
        return PushObservation(q, self._arm.tool_pose(q), p_WK, d_W, left)

    def _object_and_goal(self, rng: np.random.Generator) -> tuple[RigidTransform, Array]:
        table, config = self._scenario.table, self._scenario.episode
        half = reachable_half_extents(table)
        for _ in range(_TRIES):
            xy = rng.uniform(-half, half)
            yaw = RollPitchYaw(0.0, 0.0, rng.uniform(-np.pi, np.pi))
            X_WO = RigidTransform(yaw, np.array([*xy, self._model.rest_height]))
            goal = rng.uniform(-half, half) if config.goal is None else np.array(config.goal)
            far = np.hypot(*(goal - xy)) >= config.goal_min_distance
            if far and self._on_table(X_WO, table):
                return X_WO, goal
        raise UserError(
            f"episode.goal_min_distance is {config.goal_min_distance:g} with goal {config.goal}; "
            f"no place of {self._model.name!r} on the table is that far from a goal"
        )

    def _on_table(self, X_WO: RigidTransform, table: TableConfig) -> bool:
        p_WV = self._model.vertices @ X_WO.rotation().matrix().T + X_WO.translation()
        half = np.array([table.length, table.width]) / 2
        return bool(np.all(np.abs(p_WV[:, :2]) <= half))

    def _arm_positions(self, rng: np.random.Generator, X_WO: RigidTransform) -> Array:
        robot = self._scenario.robot
        lower, upper = np.array(robot.start_lower), np.array(robot.start_upper)
        for _ in range(_TRIES):
            q = rng.uniform(lower, upper) + rng.normal(scale=robot.start_deviation, size=len(lower))
            q = np.clip(q, self._arm.limits.lower, self._arm.limits.upper)
            X_WE = self._arm.tool_pose(q)
            high = X_WE.translation()[2] >= robot.start_tool_height
            away = float(np.linalg.norm(X_WE.translation() - X_WO.translation()))
            if not (high and away >= robot.start_object_distance):
                continue
            X_EO = X_WE.inverse() @ X_WO
            p_EP = self._model.p_OP @ X_EO.rotation().matrix().T + X_EO.translation()
            if PALM.distance(p_EP) >= _PALM_DISTANCE:
                return np.asarray(q)
        raise UserError(
            "robot.start_lower and start_upper: no start position in that box keeps the tool "
            f"{robot.start_tool_height:g} m above the table and "
            f"{robot.start_object_distance:g} m from the object"
        )


def reachable_half_extents(table: TableConfig) -> Array:
    """Returns the half-extents (2,) of the part of the table where things are placed, m."""
    return np.array([table.length, table.width]) * table.reachable / 2
