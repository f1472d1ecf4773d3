"""What a report calls those who drove."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from keypush.policies import is_own_policy
from keypush.reporting.runs import RUN
from keypush.reporting.settings import read_settings

_DIGESTS = ("weights_sha256", "policy_sha256")
_SUFFIX = ".safetensors"


class _Source(NamedTuple):
    """Who drove, as records of one folder and the files beside them tell it."""

    policy: str
    weights: str
    run: str
    folder: str

    def digest(self) -> str:
        """Of the weights or of the policy's own file; empty where nothing tells it."""
        job = read_settings(Path(self.run) / self.folder / "job.yaml")
        return next((str(job[name]) for name in _DIGESTS if name in job), "")

    def places(self) -> Iterator[Path]:
        """Where the driver's file lay and where its records lie; the last one is it alone."""
        yield _folder_of_driver(read_settings(Path(self.run) / self.folder / "scenario.yaml"))
        yield Path(self.run).resolve()
        yield (Path(self.run) / self.folder).resolve()

    def name(self, *, several_files: bool, place: str) -> str:
        """What it is called: the policy, and what tells it from others of that name."""
        told = [self.weights.removesuffix(_SUFFIX) or "no weights"] if several_files else []
        told += [place] if place else []
        return f"{self.policy} ({', '.join(told)})" if told else self.policy


def name_drivers(columns: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    """Names who drove, for every episode (N,).

    That is the policy alone, unless it drove with weights of several names; or unless weights or
    its own file had several contents under one name, as far as there is a job.yaml that tells.
    """
    named = (columns[name].tolist() for name in ("policy", "weights", RUN, "folder"))
    rows = [_Source(*row) for row in zip(*named, strict=True)]
    digests = {source: source.digest() for source in dict.fromkeys(rows)}
    files: dict[str, set[str]] = {}
    for source in digests:
        files.setdefault(source.policy, set()).add(source.weights)
    places = _places(digests)
    names = {
        source: source.name(
            several_files=len(files[source.policy]) > 1,
            place=places.get((source.policy, source.weights, digest), ""),
        )
        for source, digest in digests.items()
    }
    return np.array([names[source] for source in rows])


def _places(digests: Mapping[_Source, str]) -> dict[tuple[str, str, str], str]:
    """Where contents of one name lay, by policy, weights and digest; none of those that are one."""
    found: dict[tuple[str, str], dict[str, tuple[Path, ...]]] = {}
    for source, digest in digests.items():
        contents = found.setdefault((source.policy, source.weights), {})
        if digest and digest not in contents:
            contents[digest] = tuple(source.places())
    return {
        (policy, weights, digest): place
        for (policy, weights), contents in found.items()
        for digest, place in _tell_apart(contents).items()
    }


def _tell_apart(contents: Mapping[str, Sequence[Path]]) -> dict[str, str]:
    """Returns for each of several digests, by its places, the end of one that no other has."""
    if len(contents) < 2:
        return {}
    places = next(
        found
        for found in zip(*contents.values(), strict=True)
        if len(set(found)) == len(found) and all(place.parts for place in found)
    )
    return dict(zip(contents, _shortest_ends(places), strict=True))


def _shortest_ends(places: Sequence[Path]) -> list[str]:
    """Cuts places that differ to as many last parts as they need to differ."""
    ends = ([Path(*place.parts[-n:]).as_posix() for place in places] for n in count(1))
    return next(found for found in ends if len(set(found)) == len(found))


def _folder_of_driver(scenario: Mapping[str, Any]) -> Path:
    """The folder of the file that drove, as it was given; no parts where it was given without."""
    policy = str(scenario.get("policy", ""))
    if is_own_policy(policy):
        return Path(policy.rpartition(":")[0]).parent
    weights = str(scenario.get("predictor.weights", ""))
    return Path(weights).parent if weights.endswith(_SUFFIX) else Path("shipped")
