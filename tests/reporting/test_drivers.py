"""Two networks, or two policies of one's own, do not become one where their files share a name."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from keypush.errors import UserError
from keypush.reporting.comparison import compare_drivers
from keypush.reporting.episodes import Episodes, gather_episodes
from keypush.reporting.runs import read_runs
from keypush.scenario import dump_scenario, parse_scenario
from tests.reporting.made_up import Record, failed, record, write_run

WEIGHTS = "surface_keypoint.safetensors"


def _describe(folder: Path, digest: str, settings: dict[str, Any]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    scenario = dump_scenario(parse_scenario(yaml.safe_dump(settings)))
    (folder / "scenario.yaml").write_text(scenario)
    own = settings["policy"].endswith(":X")
    job = {"policy_sha256" if own else "weights_sha256": 64 * digest}
    (folder / "job.yaml").write_text(yaml.safe_dump(job))


def _network(folder: Path, digest: str, weights: str, *records: Record) -> Path:
    """An evaluation of a trained network, one episode if none are given."""
    mine = records or (record(),)
    known = {"policy": "surface", "weights": Path(weights).name, "folder": "."}
    write_run(folder, [r | known for r in mine])
    _describe(folder, digest, {"policy": "surface", "predictor": {"weights": weights}})
    return folder


def _own(folder: Path, digest: str, policy: str) -> Path:
    write_run(folder, [record(policy=Path(policy).name, folder=".")])
    _describe(folder, digest, {"policy": policy})
    return folder


def _drivers(*runs: Path) -> list[str]:
    return _episodes(*runs).values("driver")


def _episodes(*runs: Path) -> Episodes:
    return gather_episodes(read_runs(runs))


def test_networks_of_one_file_name_have_rows_of_their_own(tmp_path: Path) -> None:
    similar = {"object": "can_2", "set": "id"}
    runs = [
        _network(tmp_path / "a", "a", f"out/first/{WEIGHTS}", record(**similar)),
        _network(tmp_path / "b", "b", f"out/second/{WEIGHTS}", failed(object="plate", set="ood")),
        _network(tmp_path / "c", "a", f"out/first/{WEIGHTS}", record(object="mug")),
    ]
    episodes = _episodes(*runs)
    assert episodes.values("driver") == ["surface (first)", "surface (second)"]
    assert [len(part) for _, part in episodes.split("driver")] == [2, 1]


def test_networks_of_one_file_name_are_compared_on_the_same_episodes(tmp_path: Path) -> None:
    first = _network(tmp_path / "a", "a", f"first/{WEIGHTS}", record(), record(episode=1))
    second = _network(tmp_path / "b", "b", f"second/{WEIGHTS}", failed(), record(episode=1))
    (compared,) = compare_drivers(_episodes(first, second))
    assert (compared.pairs, compared.only_first, compared.only_second) == (2, 1, 0)


@pytest.mark.parametrize(
    ("first", "second", "names"),
    [
        (f"x/one/run/{WEIGHTS}", f"y/two/run/{WEIGHTS}", ["one/run", "two/run"]),
        (f"mine/{WEIGHTS}", WEIGHTS, ["a", "b"]),
        (f"mine/{WEIGHTS}", f"mine/{WEIGHTS}", ["a", "b"]),
        ("mine/surface.safetensors", "auto", ["mine", "shipped"]),
        ("auto", "auto", ["a", "b"]),
    ],
)
def test_names_are_the_shortest_folders_that_differ(
    first: str, second: str, names: list[str], tmp_path: Path
) -> None:
    runs = [_network(tmp_path / f"{d}", d, w) for d, w in (("a", first), ("b", second))]
    for run in runs:
        write_run(run, [record(policy="surface", weights="w.safetensors", folder=".")])
    assert _drivers(*runs) == [f"surface ({name})" for name in names]


def test_policies_of_ones_own_are_told_apart_by_the_folder_of_their_file(tmp_path: Path) -> None:
    runs = _own(tmp_path / "a", "a", "left/p.py:X"), _own(tmp_path / "b", "b", "right/p.py:X")
    assert _drivers(*runs) == ["p.py:X (left)", "p.py:X (right)"]
    again = _own(tmp_path / "c", "c", "right/p.py:X")
    assert _drivers(*runs, again) == [f"p.py:X ({name})" for name in "abc"]


def test_names_of_files_are_told_beside_folders(tmp_path: Path) -> None:
    runs = [
        _network(tmp_path / "a", "a", f"first/{WEIGHTS}"),
        _network(tmp_path / "b", "b", f"second/{WEIGHTS}"),
        _network(tmp_path / "c", "c", "second/best.safetensors"),
    ]
    assert _drivers(*runs) == [
        "surface (surface_keypoint, first)", "surface (surface_keypoint, second)",
        "surface (best)",
    ]  # fmt: skip


def test_evaluations_of_several_conditions_are_one_place(tmp_path: Path) -> None:
    for name in "ab":
        folders = ["conditions/size_1", "conditions/size_0.75"]
        mine = [record(policy="surface", weights="surface.safetensors", folder=f) for f in folders]
        write_run(tmp_path / name, [mine[0], mine[1] | {"size_ratio": 0.75}])
        for folder in folders:
            _describe(tmp_path / name / folder, name, {"policy": "surface"})
    assert _drivers(tmp_path / "a", tmp_path / "b") == ["surface (a)", "surface (b)"]


def test_records_that_lie_alone_have_the_name_alone(tmp_path: Path) -> None:
    first = _network(tmp_path / "a", "a", f"first/{WEIGHTS}")
    alone = _network(tmp_path / "b", "b", f"second/{WEIGHTS}", failed())
    (alone / "job.yaml").unlink()
    with pytest.raises(UserError, match="b: success of episode 0"):
        _episodes(first, alone)
    other = _network(tmp_path / "c", "c", f"third/{WEIGHTS}")
    assert _drivers(first, alone, other) == ["surface (first)", "surface", "surface (third)"]


def test_the_same_contents_are_one_driver(tmp_path: Path) -> None:
    runs = [_network(tmp_path / name, "a", f"{name}/{WEIGHTS}") for name in "ab"]
    assert _drivers(*runs) == ["surface"]
    assert len(_episodes(*runs)) == 1
