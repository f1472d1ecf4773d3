"""Scripts answer a user's mistake with one line, write nothing, and end with status 2."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"
SAMPLE = str(SCRIPTS.parent / "docs" / "sample")

MISTAKES = [
    (["draw_data.py", "data", SAMPLE, "o.png"], "draw_data: data/meta/info.json: cannot be read"),
    (["offline_errors.py", SAMPLE, "o.json", "expert"], "offline_errors: policy is 'expert'"),
    (["study_expert.py", "out", "tuned", "typo"], "study_expert: condition is 'typo'; allowed: "),
    (["report_expert.py", "runs"], "report_expert: runs: holds no condition"),
    (["build_objects.py", "teapot"], "build_objects: object is 'teapot'; allowed: block"),
    (["study_data_size.py", SAMPLE, "auto", "data", "out"], "study_data_size: data/meta/info"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("words", "told"), MISTAKES, ids=lambda value: str(value)[:30])
def test_mistakes_are_one_line(words: list[str], told: str, tmp_path: Path) -> None:
    command = [sys.executable, str(SCRIPTS / words[0]), *words[1:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(told)
    assert done.stderr.count("\n") == 1
    assert not any(tmp_path.iterdir())


@pytest.mark.slow
def test_an_unfinished_condition_does_not_replace_a_finished_one(tmp_path: Path) -> None:
    folder = tmp_path / "runs" / "tuned"
    (folder / "episodes").mkdir(parents=True)
    (folder / "job.yaml").write_text("objects: [mug]\nepisodes: 20\n")
    script = SCRIPTS / "report_expert.py"
    command = [sys.executable, str(script), str(tmp_path / "runs")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "tuned: 0 of 20 episodes are there; allowed: " in done.stderr
