"""The verb `objects`."""

import json
import os
import shutil
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from keypush.checking import object_checks
from keypush.cli.main import main
from keypush.objects.catalogue import catalogue_names
from keypush.objects.generators.solids import box
from keypush.objects.library import object_folder
from keypush.objects.manifolds import to_mesh


@pytest.fixture(autouse=True)
def data_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.fixture
def crate(tmp_path: Path) -> str:
    path = tmp_path / "crate.obj"
    to_mesh(box((80.0, 50.0, 40.0))).export(path)
    return str(path)


def test_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["objects", "list", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert list(listed) == catalogue_names()
    assert listed["mug"]["split"] == "train"
    assert listed["mug"]["faces_touching"] > 100
    assert main(["objects", "list"]) == 0
    table = capsys.readouterr().out
    assert all(name in table for name in catalogue_names())


def test_an_object_that_cannot_be_read_does_not_hide_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = tmp_path / "data" / "keypush" / "objects" / "mine"
    shutil.copytree(object_folder("mug"), mine)
    assert main(["objects", "list", "--json"]) == 0
    assert "mine" in json.loads(capsys.readouterr().out)
    text = (mine / "object.json").read_text()
    (mine / "object.json").write_text(text.replace('"mass": 0.1', '"mass": -1'))
    for arguments in (["--json"], []):
        assert main(["objects", "list", *arguments]) == 2
        captured = capsys.readouterr()
        assert all(name in captured.out for name in catalogue_names())
        assert captured.err.startswith(f"keypush: object folder {mine}: cannot be read: ")
        assert captured.err.count("\n") == 1
    assert main(["objects", "show", "mine", "--out", str(tmp_path / "o")]) == 2
    assert "object.json: mass is -1" in capsys.readouterr().err


def test_show_writes_a_page_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["objects", "show", "mug", "--out", str(tmp_path / "o")]) == 0
    assert "trained on" in capsys.readouterr().out
    page = (tmp_path / "o" / "mug.html").read_text()
    assert "keypush: mug" in page
    assert "centre of mass" in page
    picture = matplotlib.image.imread(tmp_path / "o" / "mug.png")
    assert picture.shape[0] >= picture.shape[1] == 640
    blue = (picture[..., 2] > picture[..., 0] + 0.2).mean()
    assert 0.1 < blue < 0.7  # the mug, on white


def test_a_sheet_shows_what_it_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "new" / "sheet.png"
    assert main(["objects", "sheet", "--objects", "mug,ring,duck", "--out", str(path)]) == 0
    picture = matplotlib.image.imread(path)
    assert picture.shape[1] == 3 * 240
    columns = np.split(picture[:240], 3, axis=1)
    assert all((column[..., :3].min(axis=2) < 0.6).mean() > 0.03 for column in columns)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["show", "mug", "--out", "."], "output file mug.png: is a folder; allowed: a file"),
        (["sheet", "--objects", "mug", "--out", "/dev/full"], "cannot be written: No space left"),
    ],
)
def test_a_picture_that_cannot_be_written_is_one_line(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "mug.png").mkdir()
    monkeypatch.chdir(tmp_path)
    if "/dev/full" in arguments and not os.access("/dev", os.W_OK):
        words = "/dev"  # where no file can be made, that is said
    assert main(["objects", *arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.err.count("\n") == 1
    assert Path("/dev/full").is_char_device()


def test_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["objects", "check", "block", "ring", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert list(report) == ["block", "ring"]
    assert all(line["ok"] is True for line in report.values())
    assert report["ring"]["tips"]["value"] == 0


def test_add_use_and_remove(crate: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["objects", "add", crate, "--name", "crate", "--mass", "0.15", "--up", "z"]) == 0
    told = capsys.readouterr().out
    assert "crate, an object that was added" in told
    assert "150 g" in told
    arguments = [
        "evaluate", "--policy", "expert", "--objects", "crate", "--episodes", "1",
        "--workers", "1", "--set", "episode.max_steps=3", "--out", str(tmp_path / "e"),
    ]  # fmt: skip
    assert main(arguments) == 0  # in another process, which finds it too
    assert main(["objects", "check", "user", "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["crate"]["ok"] is True
    assert main(["objects", "remove", "crate"]) == 0
    assert main(["objects", "show", "crate"]) == 2


def test_a_box_of_the_smallest_size_is_added(crate: str) -> None:
    assert main(["objects", "add", crate, "--name", "crate", "--scale", "0.02"]) == 0


def test_what_fails_a_check_is_told_with_its_limit(
    crate: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(object_checks, "LEAST_SURFACE_LIMIT", 0.0)
    assert main(["objects", "add", crate, "--name", "crate", "--scale", "0.02"]) == 2
    error = capsys.readouterr().err
    assert "what touches from what is seen, m (0.000" in error
    assert ", limit 0.0003)" in error


MISTAKES: list[tuple[list[str], list[str]]] = [
    (["add", "missing.stl", "--name", "a"], ["missing.stl"]),
    (["add", "CRATE", "--name", "mug"], ["'mug'", "taken"]),
    (["add", "CRATE", "--name", "Big"], ["'Big'", "small letters"]),
    (["add", "CRATE", "--name", "a", "--scale", "7"], ["--scale is 7.0", "0.02 to 0.5"]),
    (["add", "CRATE", "--name", "a", "--mass", "1", "--density", "1"], ["--mass and --density"]),
    (
        ["add", "CRATE", "--name", "a", "--density", "25000", "--scale", "0.5"],
        ["--density 25000.0 makes it ", " kg; allowed: 0.001 to 10 kg"],
    ),
    (["show", "teapot"], ["'teapot'", "mug"]),
    (["check", "teapot"], ["'teapot'", "mug"]),
    (["check", "user"], ["'user'", "names none"]),
    (["sheet", "--objects", ","], ["','"]),
    (["sheet", "--out", "."], ["output file .", "folder"]),
    (["remove", "mug"], ["'mug'", "none was added"]),
]


@pytest.mark.parametrize(("arguments", "words"), MISTAKES, ids=lambda value: " ".join(value)[:60])
def test_mistakes_are_one_line_and_status_2(
    arguments: list[str],
    words: list[str],
    crate: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert main(["objects", *(crate if a == "CRATE" else a for a in arguments)]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("keypush: ")
    assert captured.err.count("\n") == 1
    assert all(word in captured.err for word in words)
    assert sorted(tmp_path.rglob("*")) == before
