"""The verb `dataset`."""

import json
from pathlib import Path

import pytest

from keypush.cli.main import main
from keypush.dataset.assemble import assemble_dataset
from keypush.dataset.features import CLOUD
from keypush.dataset.read import open_dataset
from tests.dataset.edit import DATA, edit_table, set_values
from tests.dataset.real_shards import write_real_shards


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    assemble_dataset(write_real_shards(folder / "shards"), folder)
    return folder


def test_info(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dataset", "info", str(data)]) == 0
    text = capsys.readouterr().out
    assert "4 episodes of 2 objects" in text
    assert "timed_out 4" in text
    assert "mug_2" in text
    assert main(["dataset", "info", str(data), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["frames"], found["fps"]) == (64, 10)


def test_check(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dataset", "check", str(data)]) == 0
    assert "WRONG" not in capsys.readouterr().out
    assemble_dataset(data / "shards", tmp_path)
    edit_table(
        tmp_path / DATA, lambda t: set_values(t, "frame_index", lambda v: v.__setitem__(3, 0))
    )
    assert main(["dataset", "check", str(tmp_path)]) == 1
    assert "WRONG numbering: found 1; allowed: 0 frames" in capsys.readouterr().out
    assert main(["dataset", "check", str(tmp_path), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["ok"] is False
    assert found["numbering"]["ok"] is False
    assert found["times"]["ok"] is True


def test_view_writes_a_page_that_plays(data: Path, tmp_path: Path) -> None:
    path = tmp_path / "new" / "page.html"
    assert main(["dataset", "view", str(data), "3", "--out", str(path)]) == 0
    page = path.read_text()
    assert "keypush: A Franka Panda pushes the mug 2" in page
    assert "Episode 3 of a data set" in page
    assert "time ran out after 15 policy steps" in page


def test_export(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["dataset", "export", str(data), "--clouds", "--out", str(tmp_path / "e")]
    assert main(arguments) == 0
    assert "4 episodes, 64 frames in" in capsys.readouterr().out
    assert open_dataset(tmp_path / "e").features[-1].name == CLOUD


MISTAKES: list[tuple[list[str], list[str]]] = [
    (["info", "nowhere"], ["nowhere/meta/info.json", "cannot be read", "allowed"]),
    (["check", "file"], ["file/meta/info.json", "cannot be read"]),
    (["view", "nowhere", "0"], ["nowhere/meta/info.json"]),
    (["view", "DATA", "4"], ["episode is 4", "0 to 3"]),
    (["view", "DATA", "-1"], ["episode is -1", "0 to 3"]),
    (["view", "DATA", "0", "--out", "."], ["output file .", "is a folder"]),
    (["export", "DATA", "--out", "e"], ["--clouds is not given"]),
    (["export", "nowhere", "--clouds", "--out", "e"], ["nowhere/meta/info.json"]),
    (["export", "DATA", "--clouds", "--out", "file"], ["output folder file", "exists"]),
    (["export", "DATA", "--clouds", "--out", "DATA"], ["is the data set's own"]),
    (["export", "DATA", "--clouds", "--out", "DATA/data/e"], ["is the data set's own, or inside"]),
]


@pytest.mark.parametrize(("arguments", "words"), MISTAKES, ids=lambda value: " ".join(value)[:60])
def test_mistakes_are_one_line_and_status_2(
    arguments: list[str],
    words: list[str],
    data: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    before = sorted(data.rglob("*"))
    assert main(["dataset", *(a.replace("DATA", str(data)) for a in arguments)]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("keypush: ")
    assert captured.err.count("\n") == 1
    assert all(word in captured.err for word in words)
    assert not (tmp_path / "e").exists()
    assert sorted(data.rglob("*")) == before
