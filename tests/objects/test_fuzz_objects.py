"""Every file, however broken, becomes an object that passes its checks, or is refused."""

from collections import Counter
from pathlib import Path

import pytest

from keypush.checking.adding import add_object_file
from keypush.checking.object_checks import check_object
from keypush.errors import UserError
from keypush.objects.library import load_object, remove_user_object, user_object_names
from tests.objects.importing.mutate import fuzz_files


def fuzz(count: int, folder: Path) -> Counter[str]:
    """Adds files; returns how many became objects, were refused, or failed which check."""
    outcomes: Counter[str] = Counter()
    for path in fuzz_files(count, folder):
        try:
            add_object_file(path, "thing")
        except UserError as error:
            kept = len(str(error).splitlines()) != 1 or user_object_names() != []
            outcomes["refused badly" if kept else "refused"] += 1
            continue
        failed = [
            name for name, check in check_object(load_object("thing")).items() if not check.ok
        ]
        outcomes[f"fails {', '.join(failed)}" if failed else "passes"] += 1
        if failed:
            print(path, failed)  # noqa: T201  # which file, shown when the test fails
        remove_user_object("thing")
    return outcomes


@pytest.fixture(autouse=True)
def data_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.mark.timeout(300)
def test_ten_broken_files(tmp_path: Path) -> None:
    outcomes = fuzz(10, tmp_path / "files")
    assert set(outcomes) == {"passes", "refused"}


@pytest.mark.slow
@pytest.mark.timeout(7200)
def test_five_hundred_broken_files(tmp_path: Path) -> None:
    outcomes = fuzz(500, tmp_path / "files")
    assert set(outcomes) == {"passes", "refused"}
