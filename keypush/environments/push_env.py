"""PushEnv: pushing as a Gymnasium environment."""

import gc
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import NoneType
from typing import Any, override

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from keypush.environments.configuration import (
    ScenarioSource,
    checked_object,
    resolve_objects,
    resolve_scenario,
)
from keypush.environments.open_episode import OpenEpisode
from keypush.environments.page import EpisodePage
from keypush.environments.reward import ENDS, Reward
from keypush.environments.spaces import (
    PORTS,
    action_limits,
    action_space,
    checked_action,
    observation_space,
)
from keypush.errors import UserError
from keypush.scenario_check import LARGEST_SEED
from keypush.seeding import make_generator
from keypush.systems.episode_monitor import Outcome

Observation = dict[str, Any]
Info = dict[str, Any]
_RESET_OPTIONS = ("episode", "object")
_SEEDS = 2**32
"""Where nobody gives a seed, one below this is drawn."""


class PushEnv(gymnasium.Env[Observation, NDArray[Any]]):
    """A Panda pushes an object on a table to a goal; one step is one policy step, 0.1 s.

    Observation: point_cloud (512, 3), com (3,), goal (2,) and hand_state (9,) in W in m, float32,
    named as in `docs/dataset.md`, and the `extras`. Action: the tool's residual (6,), or the
    keypoint p_WK (3,) at which keypush's planner pushes; beyond the space's bounds it is clipped.
    Reward: 1 for success, plus the difference of a potential if wanted; see `Reward`.
    Terminated: success, or the object toppled or fell. Truncated: after `episode.max_steps`.
    Info: outcome, success, distance, steps, object, seed, episode_number.

    The episodes are those of keypush: seed, object and number say which. `docs/gymnasium.md`
    tells more.

    It stands on Drake's Simulator and not on `pydrake.gym.DrakeGymEnv`, which initialises the
    simulator before its reset handler has set the start and not after it, takes no options of
    `reset`, observes one port, leaves `info` empty, has one simulator (here: one for each
    object), and hears of an episode's end from the monitor's update, which is the first thing of
    the next step.
    """

    metadata: dict[str, Any] = {"render_modes": ["meshcat"], "render_fps": 10}  # noqa: RUF012 (Gymnasium reads it from the class)

    def __init__(
        self,
        object: str | None = None,  # noqa: A002 (as the scenario calls it)
        *,
        objects: str | Sequence[str] | None = None,
        scenario: ScenarioSource | None = None,
        action: str = "residual",
        extras: Sequence[str] = (),
        shaping: float = 0.0,
        discount: float = 0.99,
        render_mode: str | None = None,
    ) -> None:
        """Checks the arguments; diagrams are built when they are first needed.

        Args:
            object: name of the object; the scenario's when neither this nor `objects` is given.
            objects: names or groups, of which every episode draws one.
            scenario: a `Scenario`, the path of its YAML, or fields by their YAML names, nested
                or with dots. Its seed and its policy are not looked at.
            action: "residual" or "keypoint".
            extras: what else to observe: state, tool_pose, object_pose.
            shaping: potential at the goal; 0 for the sparse reward.
            discount: the learner's discount factor, for the potential.
            render_mode: None or "meshcat".

        Raises:
            UserError: an argument is not allowed.
        """
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise UserError(f"render_mode is {render_mode!r}; allowed: None, 'meshcat'")
        self._scenario = resolve_scenario(scenario)
        self._objects = resolve_objects(object, objects, self._scenario)
        self._limits = action_limits(self._scenario, action)
        self._port = PORTS[action]
        table = self._scenario.table
        self._reward = Reward(shaping, discount, float(np.hypot(table.length, table.width)))
        self.action_space = action_space(self._limits)
        self._spaces = observation_space(self._scenario, extras)
        self.observation_space = self._spaces
        self.render_mode = render_mode
        self._page = None if render_mode is None else EpisodePage()
        self._built: dict[str, OpenEpisode] = {}
        self._seed: int | None = None
        self._next = 0
        self._running: OpenEpisode | None = None

    @override
    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Starts an episode: the first of a seed, else the one after the last.

        Args:
            seed: the scenario's seed from now on; one is drawn where none was ever given. Another
                seed is another set of surface points, for which diagrams are built anew.
            options: `episode`, the number of the episode, from which they are counted on;
                `object`, the name of its object.

        Raises:
            UserError: unknown option or object, seed out of range, no start keeps the scenario's
                distances.
        """
        super().reset(seed=seed)
        wanted = _checked_options(options)
        self._running = None  # whatever fails from here on
        if seed is not None or self._seed is None:
            self._use_seed(int(self.np_random.integers(_SEEDS)) if seed is None else int(seed))
        episode = wanted.get("episode", self._next)
        running = self._open(wanted.get("object", self._draw_object(episode)))
        running.reset(episode)
        self._next = episode + 1
        self._episode, self._running = episode, running
        self._distance = running.distance()
        if self._page is not None:
            self._page.begin(running)
        return self._observe(running), self._info(running, Outcome.RUNNING)

    @override
    def step(self, action: Any) -> tuple[Observation, float, bool, bool, Info]:
        """Acts for one policy step; see the class.

        Raises:
            UserError: the action has another shape, or is not finite.
            ResetNeeded: no episode runs.
            RuntimeError: the simulation failed.
        """
        running = self._running
        if running is None:
            raise ResetNeeded("no episode runs: call reset() first")
        running.advance(checked_action(action, self._limits))
        before, self._distance = self._distance, running.distance()
        outcome = running.outcome()
        if outcome != Outcome.RUNNING:
            self._running = None
        reward = self._reward(before, self._distance, outcome)
        ended, cut = outcome in ENDS, outcome == Outcome.TIMED_OUT
        return self._observe(running), reward, ended, cut, self._info(running, outcome)

    @override
    def render(self) -> Any:
        """Returns a self-contained HTML page that plays the episode so far; None without a mode."""
        return None if self._page is None else self._page.html()

    @property
    def url(self) -> str | None:
        """Where a browser can watch; None without a render mode."""
        return None if self._page is None else self._page.url

    @override
    def close(self) -> None:
        """Frees diagrams and Meshcat; the next `reset` would build diagrams again."""
        self._page = None
        self._forget_diagrams()

    def _use_seed(self, seed: int) -> None:
        if seed != self._seed:
            scenario = replace(self._scenario, seed=seed)
            scenario.validate()
            self._forget_diagrams()
            self._scenario, self._seed = scenario, seed
        self._next = 0

    def _forget_diagrams(self) -> None:
        self._running = None
        self._built.clear()
        gc.collect()  # Diagrams stand in reference cycles, and Python does not see their size.

    def _draw_object(self, episode: int) -> str:
        draw = make_generator(self._scenario.seed, episode, "environment_object")
        return self._objects[draw.integers(len(self._objects))]

    def _open(self, name: str) -> OpenEpisode:
        if name not in self._built:
            scenario = replace(self._scenario, object=replace(self._scenario.object, name=name))
            meshcat = None if self._page is None else self._page.meshcat
            self._built[name] = OpenEpisode(scenario, self._port, meshcat)
        return self._built[name]

    def _observe(self, running: OpenEpisode) -> Observation:
        return {
            name: running.observe(name).astype(space.dtype) for name, space in self._spaces.items()
        }

    def _info(self, running: OpenEpisode, outcome: Outcome) -> Info:
        return {
            "outcome": outcome.name.lower(),
            "success": outcome == Outcome.SUCCESS,
            "distance": self._distance,
            "steps": running.steps,
            "object": running.scenario.object.name,
            "seed": self._scenario.seed,
            "episode_number": self._episode,
        }


def _checked_options(options: Mapping[str, Any] | None) -> dict[str, Any]:
    """Returns the options of a reset, with a plain int for the episode."""
    if not isinstance(options, Mapping | NoneType):
        raise UserError(f"options is {options!r}; allowed: a mapping, or None")
    wanted = dict(options or {})
    for name in wanted:
        if name not in _RESET_OPTIONS:
            raise UserError(f"option {name!r} is unknown; allowed: {', '.join(_RESET_OPTIONS)}")
    if "episode" in wanted:
        episode = wanted["episode"]
        whole = isinstance(episode, int | np.integer) and not isinstance(episode, bool)
        if not whole or not 0 <= episode <= LARGEST_SEED:
            raise UserError(
                f"option episode is {episode!r}; allowed: a whole number from 0 to {LARGEST_SEED}"
            )
        wanted["episode"] = int(episode)
    if "object" in wanted:
        wanted["object"] = checked_object(wanted["object"])
    return wanted
