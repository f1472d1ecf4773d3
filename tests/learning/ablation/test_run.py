"""Whole ablations of trainings that take moments, and what is refused before them."""

import json
import shutil
from pathlib import Path

import pytest

from keypush.errors import UserError
from keypush.learning.ablation.checks import claim_folder
from keypush.learning.ablation.config import AblationConfig
from keypush.learning.ablation.report import write_report
from keypush.learning.ablation.results import FILE, Ablation, read_ablation
from keypush.learning.ablation.run import run_ablation
from keypush.learning.ablation.settings import SETTINGS
from keypush.learning.imitation import token_cache
from tests.learning.ablation.sample import HELD_OUT, short_config, write_small_data


def _run(
    data: Path, out: Path, config: AblationConfig | None = None, workers: int = 2
) -> tuple[Ablation, list[str]]:
    told: list[str] = []
    return run_ablation(data, out, config or short_config(), workers, told.append), told


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_small_data(tmp_path_factory.mktemp("data"))


@pytest.fixture(scope="module")
def whole(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of an undisturbed ablation."""
    out = tmp_path_factory.mktemp("whole")
    _, told = _run(data, out)
    assert "4 encoders and 16 heads to train: about" in told[0]
    assert sum("GB on disk" in line and "token cache" in line for line in told) == 4
    return out


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_run_leaves_every_training_and_no_cache(whole: Path, tmp_path: Path) -> None:
    ablation = read_ablation(whole)
    assert [training.setting for training in ablation.trainings] == list(SETTINGS)
    assert all(len(training.epochs) == 2 for training in ablation.trainings)
    assert all(tuple(training.objects) == HELD_OUT for training in ablation.trainings)
    assert len({training.held_out_error for training in ablation.trainings}) == 16
    assert ablation.provenance["data"]["trained_rows"] == 12 * 8
    assert not (whole / "cache").exists()
    for card in whole.glob("encoders/*/contact.json"):
        assert not {*json.loads(card.read_text())["data"]["objects"]}.intersection(HELD_OUT)
    write_report(ablation, tmp_path / "page.md")
    page = (tmp_path / "page.md").read_text()
    assert all(f"{100 * ablation.errors(setting)[0]:.3f}" in page for setting in SETTINGS)


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_only_what_is_missing_is_trained_and_with_the_same_bits(
    whole: Path, data: Path, tmp_path: Path
) -> None:
    out = shutil.copytree(whole, tmp_path / "out")
    (out / FILE).unlink()
    gone = [out / "records" / f"{SETTINGS[k].name}_seed0.json" for k in (1, 14)]
    kept = {path: path.stat().st_mtime_ns for path in out.glob("records/*")}
    for path in gone:
        path.unlink()
        del kept[path]
    shutil.rmtree(out / "encoders" / SETTINGS[14].shape.name)
    _, told = _run(data, out, workers=1)
    assert "1 encoders and 2 heads to train" in told[0]
    for path in (out / FILE, *gone):
        assert path.read_bytes() == (whole / path.relative_to(out)).read_bytes()
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    _, told = _run(data, out)
    assert told == []


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_more_seeds_may_be_asked_for_and_other_settings_not(
    whole: Path, data: Path, tmp_path: Path
) -> None:
    out = shutil.copytree(whole, tmp_path / "out")
    config = short_config()
    config.seeds = (0, 1)
    ablation, told = _run(data, out, config)
    assert "0 encoders and 16 heads to train" in told[0]
    first = read_ablation(whole)
    for setting in SETTINGS:
        assert ablation.of(setting)[0] == first.of(setting)[0]
    with pytest.raises(UserError, match=r"with other values of head\.batch, head\.epochs; allowed"):
        _run(data, out, short_config(epochs=3, batch=16))
    other = write_small_data(tmp_path / "other", episodes=4)
    with pytest.raises(UserError, match=r"settings\.json: .* with other values of data; allowed"):
        _run(other, out)


def test_a_folder_belongs_to_its_settings(tmp_path: Path) -> None:
    identity = short_config().identity()
    claim_folder(tmp_path, identity)
    claim_folder(tmp_path, identity)
    with pytest.raises(UserError, match=r"settings\.json: .* other values of head\.epochs; allow"):
        claim_folder(tmp_path, short_config(epochs=5).identity())
    (tmp_path / "settings.json").write_text("{")
    with pytest.raises(UserError, match=r"settings\.json: is damaged; allowed: another"):
        claim_folder(tmp_path, identity)


def test_data_without_an_object_is_refused(tmp_path: Path) -> None:
    data = write_small_data(tmp_path / "data", without="bowl", episodes=1)
    with pytest.raises(UserError, match=r"no successful episode of bowl; allowed: the 16 objects"):
        _run(data, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    config = short_config()
    config.held_out_objects = ("bowl", "mug")
    with pytest.raises(UserError, match=r"held_out_objects has bowl; allowed: block, book"):
        _run(data, tmp_path / "out", config)


def test_a_disk_without_room_is_refused_before_the_work(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(token_cache, "_SPARE", 2**60)
    with pytest.raises(UserError, match=r"needs .* GB are free; allowed: a smaller rows_per_obj"):
        _run(data, tmp_path / "out")
    assert sorted(path.name for path in (tmp_path / "out").rglob("*")) == ["cache", "settings.json"]
