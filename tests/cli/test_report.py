"""`keypush report` on records of evaluations."""

from pathlib import Path

import pytest

from keypush.cli.main import main
from tests.reporting.made_up import failed, many_records, record, write_run


def test_page_and_markdown_are_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = [
        write_run(tmp_path / policy, many_records({policy: 0.8}, episodes=2))
        for policy in ("expert", "centroid")
    ]
    (runs[0] / "recordings").mkdir()
    (runs[0] / "recordings" / "mug-1.html").write_text("")
    page, markdown = tmp_path / "new" / "report.html", tmp_path / "results.md"
    arguments = [*map(str, runs), "--out", str(page), "--markdown", str(markdown)]
    assert main(["report", *arguments]) == 0
    assert capsys.readouterr().out == f"written: {page}\nwritten: {markdown}\n"
    html = page.read_text(encoding="utf-8")
    assert html.startswith("<!doctype html>")
    assert 'href="../expert/recordings/mug-1.html"' in html
    assert "expert \N{MINUS SIGN} centroid" in markdown.read_text(encoding="utf-8")


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    write_run(tmp_path / "good", [record()])
    write_run(tmp_path / "other", [failed()])
    write_run(tmp_path / "none", [])
    write_run(tmp_path / "damaged", [record()])
    (tmp_path / "damaged" / "records.parquet").write_bytes(b"PAR1 and no more")
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], ["no RUN is given"]),
        (["missing"], ["missing: holds no records.parquet", "keypush evaluate"]),
        (["good", "folder"], ["folder: holds no records.parquet"]),
        (["damaged"], ["damaged/records.parquet", "cannot be read"]),
        (["none"], ["none: no episode"]),
        (["good", "other"], ["other: success of episode 0", "False here and True in good"]),
        (["good", "--out", "folder"], ["output file folder"]),
        (["good", "--markdown", "folder"], ["output file folder"]),
        (["good", "--out", "x", "--markdown", "./x"], ["--out and --markdown are both x"]),
    ],
    ids=lambda value: " ".join(value)[:40],
)
def test_mistakes_are_one_line_and_status_2(
    arguments: list[str],
    words: list[str],
    workplace: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = sorted(workplace.rglob("*"))
    assert main(["report", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("keypush: ")
    assert captured.err.count("\n") == 1
    for word in words:
        assert word in captured.err
    if "--out" not in arguments:
        assert sorted(workplace.rglob("*")) == before
