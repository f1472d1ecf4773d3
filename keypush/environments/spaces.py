"""What an environment's observations and actions look like."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from keypush.errors import UserError
from keypush.robot.panda import NUM_JOINTS
from keypush.scenario import Scenario

Array = NDArray[np.float64]

PORTS = {"residual": "tool_action", "keypoint": "keypoint"}
"""Kinds of action, and the port that each drives."""
OBSERVED = ("point_cloud", "com", "goal", "hand_state")
"""What a policy of the thesis sees; names, units and frames as in `docs/dataset.md`."""
EXTRAS = ("state", "tool_pose", "object_pose")
"""What else can be observed; the last is the truth that no sensor tells."""
_FAR = 10.0
"""Nothing that an episode sees is farther from Wo, m; tables are up to 5 m long."""
_FAST = 100.0
"""Far beyond the joints' velocity limits, which the simulated arm may exceed, rad/s."""
_HIGHEST_KEYPOINT = 0.3
"""A built-in object at its largest is not higher, m."""


def observation_space(scenario: Scenario, extras: Iterable[str]) -> spaces.Dict:
    """Returns the space of observations.

    Args:
        scenario: sizes of table and cloud.
        extras: names out of `EXTRAS`.

    Raises:
        UserError: there is no such name.
    """
    if isinstance(extras, str) or not isinstance(extras, Iterable):
        raise UserError(f"extras is {extras!r}; allowed: names out of {', '.join(EXTRAS)}")
    names = (*OBSERVED, *extras)
    boxes = _boxes(scenario)
    for name in names:
        if not isinstance(name, str) or name not in boxes:
            raise UserError(f"extras has {name!r}; allowed: {', '.join(EXTRAS)}")
    return spaces.Dict({name: boxes[name] for name in names})


def action_space(limits: tuple[Array, Array]) -> spaces.Box:
    """Returns the space of actions within their limits."""
    return _box(*limits)


def action_limits(scenario: Scenario, kind: str) -> tuple[Array, Array]:
    """Returns the lowest and the highest action of one kind, both (6,) or (3,), in float64.

    Raises:
        UserError: there is no such kind.
    """
    if kind == "residual":
        control = scenario.control
        high = np.repeat([control.max_translation, control.max_rotation], 3)
        return -high, high
    if kind == "keypoint":
        half = _table_half(scenario)
        return np.array([*-half, 0.0]), np.array([*half, _HIGHEST_KEYPOINT])
    raise UserError(f"action is {kind!r}; allowed: {', '.join(PORTS)}")


def checked_action(action: Any, limits: tuple[Array, Array]) -> Array:
    """Returns an action in float64, clipped to its limits.

    These and not the space's bounds, which are rounded to float32.

    Raises:
        UserError: wrong shape, no numbers, or not all finite.
    """
    shape = limits[0].shape
    try:
        if np.iscomplexobj(action):
            raise TypeError("complex")
        values = np.asarray(action, dtype=float)
    except (TypeError, ValueError, OverflowError) as error:
        raise UserError(f"action is {action!r}; allowed: {shape[0]} numbers") from error
    if values.shape != shape:
        raise UserError(f"action has the shape {values.shape}; allowed: {shape}")
    if not np.all(np.isfinite(values)):
        raise UserError(f"action is {values.tolist()}; allowed: finite numbers")
    return np.asarray(np.clip(values, *limits))


def _boxes(scenario: Scenario) -> dict[str, spaces.Box]:
    half, points = _table_half(scenario), scenario.noise.cloud_points
    far, one = np.full(3, _FAR), np.ones(6)
    hand, state = np.concatenate([far, one]), np.repeat([2 * np.pi, _FAST], NUM_JOINTS)
    pose = np.concatenate([one[:4], far])
    return {
        "point_cloud": _box(np.full((points, 3), -_FAR), np.full((points, 3), _FAR)),
        "com": _box(-far, far),
        "goal": _box(-half, half),
        "hand_state": _box(-hand, hand),
        "state": _box(-state, state),
        "tool_pose": _box(-pose, pose),
        # In full precision, as in the data set: clouds can be rebuilt from it.
        "object_pose": spaces.Box(-pose, pose, dtype=np.float64),
    }


def _box(low: Array, high: Array) -> spaces.Box:
    return spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def _table_half(scenario: Scenario) -> Array:
    return np.array([scenario.table.length, scenario.table.width]) / 2
