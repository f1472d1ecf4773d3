"""What is measured of every frame of a data set, and how far it may be off."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from keypush.dataset.arrays import not_finite, to_array
from keypush.dataset.features import CLOUD
from keypush.dataset.keypoint import keypoints
from keypush.dataset.poses import POSES, QUATERNION_ERROR, quaternion_errors, rotations
from keypush.dataset.read import DataSet
from keypush.objects.library import make_object

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

LONGEST_TIME_ERROR = 1e-5
"""s; a frame's time is a float32."""
MOST_LABEL_DISTANCE = 0.02
"""Of a keypoint from the object's surface, m: several contacts have their centroid between them."""
LABEL_ERROR = 1e-6
"""Of a stored keypoint from the one that contacts and poses give, m."""


@dataclass(frozen=True)
class Check:
    """One property of a data set."""

    ok: bool
    found: str
    allowed: str


@dataclass(frozen=True)
class _Part:
    """Consecutive frames, and what the table of episodes says of them."""

    columns: dict[str, NDArray[Any]]
    index: Whole
    """Number of each frame in the data set."""
    episode: Whole
    """Row of each frame's episode in the table of episodes."""
    first: Whole
    """Number of the first frame of each frame's episode."""
    last: Whole
    """Of the last one."""


def frame_checks(dataset: DataSet) -> dict[str, Check]:
    """Takes every measure of every part, but for those that need poses where these are none.

    Reads every frame once.

    Raises:
        UserError: a file is missing or damaged, or an object is not there any more.
    """
    worst = dict.fromkeys(_MEASURES, 0.0)
    bad: list[str] = []
    for part in _parts(dataset):
        for name, (measure, _, _) in _MEASURES.items():
            if not (bad and name in _NEED_POSES):
                worst[name] = max(worst[name], measure(dataset, part))
            bad = [name for name in _GIVE_POSES if worst[name] > _MEASURES[name][1]]
    checks = {}
    for name, (_, limit, allowed) in _MEASURES.items():
        if bad and name in _NEED_POSES:
            checks[name] = Check(False, f"not measured, because {bad[0]} is wrong", allowed)
        else:
            checks[name] = Check(worst[name] <= limit, f"{worst[name]:.4g}", allowed)
    return checks


def _parts(dataset: DataSet) -> Iterator[_Part]:
    first, end = (to_array(dataset.episodes[f"dataset_{name}_index"]) for name in ("from", "to"))
    names = [feature.name for feature in dataset.features]
    begin = 0
    for table in dataset.batches(names):
        index = np.arange(begin, begin + len(table))
        episode = np.searchsorted(end, index, side="right")
        columns = {name: to_array(table[name]) for name in names}
        yield _Part(columns, index, episode, first[episode], end[episode] - 1)
        begin += len(table)


def _misnumbered(dataset: DataSet, part: _Part) -> float:
    numbers = to_array(dataset.episodes["episode_index"])[part.episode]
    found = part.columns
    wrong = (
        (found["index"] != part.index)
        | (found["episode_index"] != numbers)
        | (found["frame_index"] != part.index - part.first)
    )
    return float(wrong.sum())


def _wrong_tasks(dataset: DataSet, part: _Part) -> float:
    tasks = dataset.episodes["tasks"].to_pylist()
    numbers = np.array([dataset.tasks.get(task[0], -1) if task else -1 for task in tasks])
    return float((part.columns["task_index"] != numbers[part.episode]).sum())


def _time_error(dataset: DataSet, part: _Part) -> float:
    expected = (part.index - part.first) / dataset.fps
    return _largest(np.abs(part.columns["timestamp"].astype(np.float64) - expected))


def _wrong_ends(dataset: DataSet, part: _Part) -> float:
    last = part.index == part.last
    success = to_array(dataset.episodes["success"])[part.episode]
    found = part.columns
    wrong = (found["next.done"] != last) | (found["next.success"] != (last & success))
    return float(wrong.sum())


def _not_finite(dataset: DataSet, part: _Part) -> float:
    count = 0
    for feature in dataset.features:
        bad = not_finite(part.columns[feature.name], may_be_nan=feature.may_be_nan)
        count += int(bad.sum())
    return float(count)


def _quaternion_error(dataset: DataSet, part: _Part) -> float:  # noqa: ARG001  # one signature
    return _largest(np.concatenate([quaternion_errors(part.columns[name]) for name in POSES]))


def _label_error(dataset: DataSet, part: _Part) -> float:  # noqa: ARG001  # one signature
    found = part.columns
    expected = keypoints(
        found["stage"], found["observation.object_pose"], found["contact.measured"], part.episode
    )
    stored = found["keypoint"].astype(np.float64)
    if (np.isnan(stored) != np.isnan(expected)).any():
        return np.inf
    return _largest(np.abs(stored - expected))


def _label_distance(dataset: DataSet, part: _Part) -> float:
    """How far keypoints are from their object's surface, m."""
    labelled = np.isfinite(part.columns["keypoint"]).all(axis=1)
    pose = part.columns["observation.object_pose"][labelled].astype(np.float64)
    offset = part.columns["keypoint"][labelled].astype(np.float64) - pose[:, 4:]
    p_OK = np.einsum("nji,nj->ni", rotations(pose), offset) if len(pose) else offset
    episode = part.episode[labelled]
    names = np.asarray(dataset.episodes["object"].to_pylist())[episode]
    ratios = to_array(dataset.episodes["size_ratio"])[episode]
    farthest = 0.0
    for name in np.unique(names):
        mine = names == name
        tree = KDTree(make_object(str(name)).p_OP)
        distance, _ = tree.query(p_OK[mine] / ratios[mine, None])
        farthest = max(farthest, _largest(distance * ratios[mine]))
    return farthest


def _cloud_distance(dataset: DataSet, part: _Part) -> float:
    """How far the middles of clouds are from their object's origin, in its own bounding radii."""
    if CLOUD not in part.columns:
        return 0.0
    return _distance_in_radii(dataset, part, part.columns[CLOUD].astype(np.float64).mean(axis=1))


def _com_distance(dataset: DataSet, part: _Part) -> float:
    """How far centres of mass are from their object's origin, in its own bounding radii."""
    return _distance_in_radii(dataset, part, part.columns["observation.com"].astype(np.float64))


def _distance_in_radii(dataset: DataSet, part: _Part, points: Array) -> float:
    """How far one point of each frame is from the object's origin, in the object's radii."""
    apart = np.linalg.norm(points - part.columns["observation.object_pose"][:, 4:], axis=1)
    names = dataset.episodes["object"].to_pylist()
    ratios = to_array(dataset.episodes["size_ratio"])
    radius = np.array(
        [make_object(names[i]).bounding_radius * ratios[i] for i in np.unique(part.episode)]
    )
    return _largest(apart / radius[np.unique(part.episode, return_inverse=True)[1]])


def _largest(values: Array) -> float:
    """The largest that is a number; 0 of none."""
    return float(np.nanmax(values, initial=0.0))


_Measure = Callable[[DataSet, _Part], float]
_MEASURES: dict[str, tuple[_Measure, float, str]] = {
    "numbering": (_misnumbered, 0.0, "0 frames whose index, episode or step is wrong"),
    "tasks": (_wrong_tasks, 0.0, "0 frames whose task is not that of their episode"),
    "times": (
        _time_error, LONGEST_TIME_ERROR, f"at most {LONGEST_TIME_ERROR:g} s off the step's time"
    ),
    "ends": (_wrong_ends, 0.0, "0 frames whose next.done or next.success is wrong"),
    "finite": (
        _not_finite, 0.0,
        "0 numbers that are not finite, but for points that are not there: NaN in all three",
    ),
    "quaternions": (_quaternion_error, QUATERNION_ERROR, f"norm 1 up to {QUATERNION_ERROR:g}"),
    "labels": (
        _label_error, LABEL_ERROR, f"at most {LABEL_ERROR:g} m off what contacts and poses give"
    ),
    "label_distance": (
        _label_distance, MOST_LABEL_DISTANCE,
        f"keypoints at most {MOST_LABEL_DISTANCE:g} m from the object's surface",
    ),
    "clouds": (_cloud_distance, 1.0, "clouds about the object, in its bounding radii"),
    "com": (_com_distance, 1.0, "centres of mass in the object's bounding sphere, in its radii"),
}  # fmt: skip
"""Of each check: what is measured, the limit, and what is allowed in words."""
_GIVE_POSES = ("finite", "quaternions")
_NEED_POSES = ("labels", "label_distance", "clouds", "com")
"""They are measured of data only that pass those above."""
