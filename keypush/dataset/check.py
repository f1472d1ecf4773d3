"""Whether a data set is whole and true to itself: every check tells what it found."""

import numpy as np
import pyarrow as pa

from keypush.dataset.arrays import to_array
from keypush.dataset.frame_checks import Check, frame_checks
from keypush.dataset.job_file import read_job
from keypush.dataset.layout import DATA_PATH
from keypush.dataset.own_objects import changed_objects
from keypush.dataset.read import DataSet
from keypush.scenario import Scenario, load_scenario

EXPERT_OUTCOMES = ("success", "toppled", "fell", "timed_out")
"""How an episode of the expert may end."""


def check_dataset(dataset: DataSet) -> dict[str, Check]:
    """Reads every frame once and returns all checks by name.

    Raises:
        UserError: a file is missing or damaged, or an object is not there any more.
    """
    dataset.check_statistics()
    scenario = load_scenario(dataset.scenario)
    checks = {
        "episodes": _every_episode_once(dataset),
        "told": _told_truly(dataset.episodes, scenario),
        "lengths": _lengths(dataset.episodes, dataset.frames),
        "files": _files(dataset),
        "objects": _own_objects(dataset),
    }
    if not checks["lengths"].ok:
        return checks
    return checks | frame_checks(dataset)


def _every_episode_once(dataset: DataSet) -> Check:
    objects, episodes = read_job(dataset.job)
    expected = [(name, i) for name in objects for i in range(episodes)]
    table = dataset.episodes
    found = list(zip(table["object"].to_pylist(), table["episode"].to_pylist(), strict=True))
    numbered = table["episode_index"].to_pylist() == list(range(len(table)))
    return Check(
        found == expected and numbered,
        f"{len(found)} episodes, {len(set(found) & set(expected))} of the job's",
        f"the {len(expected)} of meta/job.yaml, each once, in its order",
    )


def _told_truly(episodes: pa.Table, scenario: Scenario) -> Check:
    """Whether the table of episodes agrees with the scenario, and its outcomes with each other."""
    told = ("seed", "policy", "outcome", "success")
    wrong = sum(
        row["seed"] != scenario.seed
        or row.get("policy", scenario.policy) != scenario.policy
        or row["outcome"] not in EXPERT_OUTCOMES
        or row["success"] != (row["outcome"] == "success")
        for row in episodes.select([n for n in told if n in episodes.column_names]).to_pylist()
    )
    return Check(
        wrong == 0,
        f"{wrong} of {len(episodes)} episodes told otherwise",
        f"seed and policy of meta/scenario.yaml ({scenario.seed}, {scenario.policy}), outcome one "
        f"of {', '.join(EXPERT_OUTCOMES)}, and success where that is success",
    )


def _own_objects(dataset: DataSet) -> Check:
    changed = changed_objects(dataset)
    found = f"other files of {', '.join(changed)}" if changed else "the same"
    return Check(not changed, found, "your own objects with the files that they had")


def _lengths(episodes: pa.Table, frames: int) -> Check:
    first, end = (to_array(episodes[f"dataset_{name}_index"]) for name in ("from", "to"))
    bounds = np.concatenate([[0], end])
    ok = (
        bool((first == bounds[:-1]).all())
        and bool((end - first == to_array(episodes["length"])).all())
        and bool((end > first).all())
        and int(bounds[-1]) == frames
    )
    return Check(
        ok,
        f"{int((end - first).sum())} frames in {len(episodes)} episodes",
        f"episodes one after the other, {frames} frames",
    )


def _files(dataset: DataSet) -> Check:
    """Whether each episode's frames are in the file that its row names."""
    named = [
        DATA_PATH.format(chunk_index=row["data/chunk_index"], file_index=row["data/file_index"])
        for row in dataset.episodes.select(["data/chunk_index", "data/file_index"]).to_pylist()
    ]
    ends = np.cumsum(dataset.frames_per_file)
    place = np.searchsorted(ends, to_array(dataset.episodes["dataset_from_index"]), side="right")
    names = [str(path.relative_to(dataset.folder)) for path in dataset.files]
    wrong = sum(
        k >= len(names) or names[k] != name for k, name in zip(place.tolist(), named, strict=True)
    )
    return Check(wrong == 0, f"{wrong} in {len(names)} files", "0 episodes in another file")
