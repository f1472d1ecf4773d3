"""Help and version."""

import re
import subprocess
import sys
from importlib.metadata import version

import pytest

from keypush.cli.main import main
from tests.cli.command import keypush

VERBS = (
    "demo",
    "collect",
    "dataset",
    "train",
    "ablate",
    "evaluate",
    "reproduce",
    "report",
    "bench",
    "diagram",
    "objects",
)


@pytest.mark.parametrize("arguments", [[], ["--help"]])
def test_help_names_every_verb(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 0
    text = capsys.readouterr().out
    for verb in VERBS:
        assert f"• {verb} " in text


@pytest.mark.parametrize("verb", VERBS)
def test_every_option_is_explained(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main([verb, "--help"])
    assert caught.value.code == 0
    text = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for option in re.findall(r"--[a-z][a-z-]*(?: [A-Z][A-Z=]*)? \((?:default|required)", text):
        pytest.fail(f"{option} has no explanation")


@pytest.mark.parametrize("verb", ["collect", "train", "ablate"])
def test_help_says_which_fields_go_before_a_presets(
    verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([verb, "--help"])
    text = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "that differ from their defaults go before; one at its default counts as not" in text


def test_version() -> None:
    assert keypush("--version").stdout == f"keypush {version('keypush')}\n"


def test_the_command_line_loads_neither_drake_nor_torch() -> None:
    code = "import sys, keypush.cli.main; print(sorted({'pydrake', 'torch'} & sys.modules.keys()))"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, check=True, text=True
    )
    assert result.stdout == "[]\n"
