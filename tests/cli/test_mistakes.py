"""Every mistake of the user's is one line that names its cause, and exit status 2."""

from pathlib import Path

import pytest

from keypush.cli.main import main
from tests.cli.command import keypush

YAML = {
    "unknown.yaml": "episode: {max_stepz: 3}",
    "nan.yaml": "noise: {cloud_deviation: .nan}",
    "range.yaml": "object: {mass: -1}",
    "broken.yaml": "episode: [",
    "list.yaml": "[1, 2]",
    "goal.yaml": "episode: {goal: [0.3, 0.0]}",
    "crowded.yaml": "episode: {goal: [0.0, 0.0], goal_min_distance: 0.5}",
}
MISTAKES: list[tuple[list[str], list[str]]] = [
    (["demo", "--object", "teapot"], ["'teapot'", "mug"]),
    (["demo", "--scenario", "missing.yaml"], ["missing.yaml", "cannot be read"]),
    (["demo", "--scenario", "folder"], ["folder", "cannot be read"]),
    (["demo", "--scenario", "binary.yaml"], ["binary.yaml", "cannot be read"]),
    (["demo", "--scenario", "broken.yaml"], ["broken.yaml"]),
    (["demo", "--scenario", "list.yaml"], ["list.yaml", "mapping"]),
    (["demo", "--scenario", "unknown.yaml"], ["unknown.yaml", "max_stepz"]),
    (["demo", "--scenario", "nan.yaml"], ["nan.yaml", "noise.cloud_deviation is nan", "0 to 0.1"]),
    (["demo", "--scenario", "range.yaml"], ["range.yaml", "object.mass is -1"]),
    (["demo", "--scenario", "goal.yaml"], ["goal.yaml", "episode.goal is [0.3, 0.0]"]),
    (["demo", "--policy", "expert", "--scenario", "crowded.yaml"], ["goal_min_distance is 0.5"]),
    (["demo", "--set", "table.color=red"], ["color"]),
    (["demo", "--set", "seed"], ["--set 'seed'", "FIELD=VALUE"]),
    (["demo", "--set", "table={", "--seed", "1"], ["--set 'table={'"]),
    (["demo", "--set", "seed=2000-13-01"], ["--set 'seed=2000-13-01': not readable"]),
    (["demo", "--set", "seed=0x_"], ["--set 'seed=0x_': not readable as YAML"]),
    (
        ["demo", "--set", "noise={cloud_points: 64, cloud_points: 32}"],
        ["{cloud_points: 64, cloud_points: 32}': cloud_points is given twice, in lines 1 and 1"],
    ),
    (["demo", "--set", f"seed={1000 * '['}"], ["not readable as YAML"]),
    (["demo", "--set", f"seed={350 * '['}{350 * ']'}"], ["nested too deeply; allowed: 20 levels"]),
    (["demo", "--set", "object=1", "--object", "mug"], ["object.name"]),
    (["demo", "--seed", "-1"], ["seed is -1"]),
    (["demo", "--policy", "keypuncher"], ["policy is 'keypuncher'", "keypoint_no_com, behavior"]),
    (["demo", "--set", "predictor.weights=nothing"], ["weights 'nothing'", ".safetensors"]),
    (["demo", "--policy", "none.py:X"], ["policy none.py:X: no file none.py in"]),
    (["demo", "--policy", "no.such:X"], ["policy no.such:X: importing it raised ModuleNotFound"]),
    (
        ["evaluate", "--policy", "keypush.policies:SHIPPED", "--out", "e"],
        ["policies.py has no class or function SHIPPED; allowed: Policy, "],
    ),
    (
        ["demo", "--policy", "behavior_cloning", "--set", "predictor.weights=surface_no_com"],
        ["policy behavior_cloning", "'surface_keypoint'; allowed here: behavior_cloning"],
    ),
    (
        ["evaluate", "--policy", "surface", "--weights", "surface_no_com", "--out", "e"],
        ["policy surface", "use_com is false; allowed: true; policy surface_no_com takes these"],
    ),
    (["evaluate", "--weights", "none.safetensors", "--out", "e"], ["none.safetensors"]),
    (["evaluate", "--weights", 300 * "w", "--out", "e"], ["www': no file ", "surface_no_com"]),
    (["evaluate", "--weights", 300 * "w" + ".safetensors", "--out", "e"], ["no file www"]),
    (["evaluate", "--objects", "mug,teapot", "--out", "e"], ["'teapot'"]),
    (["evaluate", "--objects", ",", "--out", "e"], ["','", "unseen"]),
    (["evaluate", "--episodes", "0", "--out", "e"], ["--episodes is 0"]),
    (["evaluate", "--sizes", "1", "9", "--out", "e"], ["--sizes: object.size_ratio is 9.0"]),
    (["evaluate", "--cloud-noise", "1", "--out", "e"], ["--cloud-noise: noise.cloud_deviation"]),
    (["evaluate", "--com-shifts", "0", "0", "--out", "e"], ["--com-shifts has 0 twice"]),
    (["evaluate", "--record-failures", "-1", "--out", "e"], ["--record-failures is -1"]),
    (
        ["evaluate", "--policy", "geometric", "--weights", "surface", "--out", "e"],
        ["--weights is 'surface', but policy geometric has none; allowed: a policy that has"],
    ),
    (["evaluate", "--out", "reproduction"], ["reproduction: holds a reproduction (tables.md)"]),
    (["evaluate", "--out", "data"], ["output folder data: holds a data set (meta)"]),
    (["reproduce", "--scale", "quick", "--out", "evaluation"], ["holds an evaluation (job.yaml)"]),
    (["reproduce", "--scale", "quick", "--out", "several"], ["holds an evaluation (conditions)"]),
    (["evaluate", "--out", "records"], ["records: holds records.parquet of another evaluation"]),
    (
        ["reproduce", "--scale", "quick", "--out", "records"],
        ["records: holds records.parquet of an evaluation; allowed: another folder"],
    ),
    (["demo", "--out", 300 * "o"], ["File name too long; allowed: a path that you may use"]),
    (["report", 300 * "r", "--out", "r.html"], ["rrr", "File name too long"]),
    (["evaluate", "--policy", 300 * "p" + ".py:X", "--out", "e"], ["ppp", "File name too long"]),
    (["evaluate", "--out", "caf\udce9"], ["caf\\udce9: is not UTF-8; allowed: names that are"]),
    (["demo", "--out", "evaluation"], ["output folder evaluation: holds an evaluation (job.yaml)"]),
    (["collect", "--workers", "0", "--out", "c"], ["--workers is 0"]),
    (["collect", "--seed", "1000000", "--out", "c"], ["seed is 1000000", "0 to 999999"]),
    (["demo", "--policy", "expert", "--out", "file"], ["output folder file", "exists"]),
    (["demo", "--policy", "expert", "--out", "file/inside"], ["file/inside", "Not a directory"]),
    (["collect", "--out", "/proc/keypush"], ["/proc/keypush", "cannot be written"]),
    (["collect", "--out", "/proc"], ["/proc", "cannot be written"]),
    (["diagram", "--policy", "expert", "--out", "folder"], ["output file folder"]),
    (["train", "--data", "missing", "--out", "t"], ["missing"]),
    (["bench", "sim", "--episodes", "0"], ["--episodes is 0"]),
    (["bench", "sim", "--set", "variation.com_shift=0.01"], ["variation is set; allowed"]),
    (["demo", "--set", "variation.mass=[2, 1]"], ["variation.mass is [2.0, 1.0]"]),
]


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("workplace")
    for name, text in YAML.items():
        (folder / name).write_text(text)
    (folder / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    (folder / "file").write_text("")
    (folder / "folder").mkdir()
    for mark in (
        "evaluation/job.yaml",
        "several/conditions",
        "reproduction/tables.md",
        "data/meta",
    ):
        (folder / mark).mkdir(parents=True)
    (folder / "records").mkdir()
    (folder / "records/records.parquet").write_text("")
    return folder


@pytest.mark.parametrize(("arguments", "words"), MISTAKES, ids=lambda value: " ".join(value)[:60])
def test_one_line_and_status_2(
    arguments: list[str],
    words: list[str],
    workplace: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(workplace)
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("keypush: ")
    assert captured.err.count("\n") == 1
    assert captured.out == ""
    for word in words:
        assert word in captured.err


@pytest.mark.parametrize(
    "arguments",
    [
        ["collect", "--episodes-per-object", "1", "--scenario", "crowded.yaml", "--out", "crowded"],
        ["demo", "--scenario", "nan.yaml"],
        ["demo", "--speed", "3"],
    ],
)
def test_the_process_itself_exits_with_status_2(arguments: list[str], workplace: Path) -> None:
    result = keypush(*arguments, cwd=workplace)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    "arguments", [["push"], ["demo", "--speed", "3"], ["demo", "--seed", "x"], ["evaluate"]]
)
def test_what_the_parser_refuses_has_status_2(arguments: list[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
