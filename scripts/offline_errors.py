"""Measures how far predicted keypoints lie from the label, on a data set of any objects.

    scripts/uv.sh run scripts/offline_errors.py DATA OUT.json [POLICY[=WEIGHTS]...]

The clouds are those that the sensor gave in the data set's episodes, to the last bit. Errors are
the distance to the measured contact, its horizontal part, and the part across the push; their means
are over frames of an object first and then over objects, so that long episodes do not weigh more.
"""

import json
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from as_command import as_command
from numpy.typing import NDArray

from keypush.cli.output import check_output_file
from keypush.dataset.arrays import to_array
from keypush.dataset.clouds import episode_clouds
from keypush.dataset.read import open_dataset
from keypush.errors import UserError
from keypush.learning.model import KeypointModel
from keypush.learning.policy_model import policy_model
from keypush.objects.listing import split_of
from keypush.policies import OWN_POLICY, POLICIES, SHIPPED, is_own_policy
from keypush.scenario import load_scenario

_EVERY = 4
"""Frames beside each other are much alike."""
_COLUMNS = ["observation.object_pose", "observation.com", "observation.goal",
            "observation.hand_state", "keypoint"]  # fmt: skip

Array = NDArray[np.float64]


def models(names: Sequence[str]) -> dict[str, KeypointModel]:
    """Makes the models of keypoint policies, by what names them: POLICY or POLICY=WEIGHTS.

    Raises:
        UserError: there is no such policy of keypoints, or it has no such weights.
    """
    found: dict[str, KeypointModel] = {}
    for given in names:
        name, _, weights = given.partition("=")
        if not (is_own_policy(name) or name in _all()):
            raise UserError(f"policy is {name!r}; allowed: {', '.join(_all())}, {OWN_POLICY}")
        model = policy_model(name, weights or SHIPPED)
        assert model is not None
        found[given] = model
    return found


def _all() -> list[str]:
    """All of keypush's own policies that predict keypoints."""
    return [name for name, policy in POLICIES.items() if name != "expert" and not policy.acts]


def frame_errors(model: KeypointModel, frames: list[tuple[Array, ...]]) -> Array:
    """Returns distance, horizontal distance and lateral distance for every frame, (n, 3), m."""
    errors = []
    for cloud, com, goal, hand, label in frames:
        off = model.predict(cloud, goal, com if model.uses_com else None, hand) - label
        d = (goal - com[:2]) / np.linalg.norm(goal - com[:2])
        lateral = abs(off[1] * d[0] - off[0] * d[1])
        errors.append([np.linalg.norm(off), np.hypot(*off[:2]), lateral])
    return np.array(errors)


def measure(data: Path, names: Sequence[str]) -> dict[str, Any]:
    """Returns the errors by policy, split and object, in cm."""
    dataset = open_dataset(data)
    noise = load_scenario(dataset.scenario).noise
    chosen = models(names)
    errors: dict[str, dict[str, list[Array]]] = {name: defaultdict(list) for name in chosen}
    for told, table in dataset.each_episode():
        pose, com, goal, hand, label = (to_array(table[c]).astype(float) for c in _COLUMNS)
        clouds = episode_clouds(noise, told, pose)
        taught = np.flatnonzero(np.isfinite(label).all(axis=1))[::_EVERY]
        frames = [(clouds[i], com[i], goal[i], hand[i], label[i]) for i in taught]
        for name, model in chosen.items():
            if frames:
                errors[name][told["object"]].append(frame_errors(model, frames))
    return {name: _by_split(found) for name, found in errors.items()}


def _by_split(found: dict[str, list[Array]]) -> dict[str, Any]:
    of_object = {name: np.concatenate(parts) for name, parts in found.items()}
    result: dict[str, Any] = {}
    for split in dict.fromkeys(split_of(name) for name in of_object):
        mine = {name: e for name, e in of_object.items() if split_of(name) == split}
        means = 100 * np.mean([e.mean(axis=0) for e in mine.values()], axis=0)
        result[split] = {
            "objects": {name: round(100 * float(e[:, 0].mean()), 3) for name, e in mine.items()},
            "frames": sum(len(e) for e in mine.values()),
            "error_cm": round(float(means[0]), 3),
            "error_xy_cm": round(float(means[1]), 3),
            "error_lateral_cm": round(float(means[2]), 3),
            "error_p90_cm": round(
                100 * float(np.quantile(np.concatenate([e[:, 0] for e in mine.values()]), 0.9)), 3
            ),
        }
    return result


def main(data: Path, out: Path, policies: tyro.conf.Positional[tuple[str, ...]] = ()) -> None:
    """Writes the errors as JSON and prints them as a table.

    Args:
        data: the data set.
        out: the JSON file.
        policies: POLICY or POLICY=WEIGHTS; by default all of keypush's that predict keypoints.
    """
    check_output_file(out)
    result = measure(data, policies or _all())
    out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    splits = list(next(iter(result.values())))
    print(f"| policy | {' | '.join(f'{s}: mean, xy, lateral, p90' for s in splits)} |")
    print("|---" * (len(splits) + 1) + "|")
    keys = ("error_cm", "error_xy_cm", "error_lateral_cm", "error_p90_cm")
    for name, by_split in result.items():
        cells = [", ".join(f"{by_split[s][key]:.2f}" for key in keys) for s in splits]
        print(f"| `{name}` | {' | '.join(cells)} |")


if __name__ == "__main__":
    as_command(main)
