"""The page says what the numbers say."""

import re
from dataclasses import replace
from pathlib import Path
from statistics import fmean

import numpy as np
import pytest
from matplotlib.image import imread

from keypush.errors import UserError
from keypush.learning.ablation.report import summary, write_report
from keypush.learning.ablation.results import Ablation
from keypush.learning.ablation.settings import SETTINGS, SHOWN, Setting
from keypush.objects.catalogue import catalogue_names
from tests.learning.ablation.sample import EPOCHS, HELD_OUT, made_up


def _error(setting: Setting, seed: int) -> float:
    return 0.01 + 0.1 * setting.thesis_error + 2e-4 * seed + 1e-4 * setting.model


def _page(ablation: Ablation, folder: Path) -> str:
    write_report(ablation, folder / "ablation.md")
    return (folder / "ablation.md").read_text(encoding="utf-8")


def _rows(page: str, heading: str) -> list[list[str]]:
    """The rows of the first table after a heading."""
    lines = page[page.index(heading) :].splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("| ---"))
    rows = []
    for line in lines[first + 1 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


def _of_data(**told: list[str]) -> Ablation:
    ablation = made_up(_error)
    data = {**ablation.provenance["data"], **told}
    return replace(ablation, provenance={**ablation.provenance, "data": data})


@pytest.mark.parametrize("told_as_trained_on", [HELD_OUT, ()])
def test_the_page_counts_the_objects_that_are_trained_on(
    told_as_trained_on: tuple[str, ...], tmp_path: Path
) -> None:
    """Older records list held-out objects among all."""
    kept = set(catalogue_names("train")).difference(HELD_OUT).union(told_as_trained_on)
    page = _page(_of_data(objects=sorted(kept)), tmp_path)
    assert "\n12 objects are trained on " in page


def test_one_object_is_told_as_one(tmp_path: Path) -> None:
    page = _page(_of_data(objects=["can"], held_out_objects=["mug"]), tmp_path)
    assert "\n1 object is trained on " in page
    assert "mug is held out" in page.replace("\n", " ")


def test_the_tables_hold_the_mean_and_the_deviation_of_the_records(tmp_path: Path) -> None:
    ablation = made_up(_error)
    page = _page(ablation, tmp_path)
    for heading, half in (
        ("## With the centre of mass (table 5.3)", SETTINGS[:8]),
        ("## Without the centre of mass (table 5.4)", SETTINGS[8:]),
    ):
        rows = _rows(page, heading)
        for row, setting in zip(rows, half, strict=True):
            errors = [100 * error for error in ablation.errors(setting)]
            told = f"{fmean(errors):.3f} ± {np.std(errors, ddof=1):.3f}"
            assert row[:4] == [
                str(setting.model), str(setting.shape.layers), str(setting.shape.patch_size),
                str(setting.heads),
            ]  # fmt: skip
            assert row[5].strip("*") == told
            assert row[9] == f"{setting.thesis_error:.4f}"
        best = min(half, key=lambda s: fmean(ablation.errors(s)))
        assert [row[5].startswith("**") for row in rows] == [s == best for s in half]
        ranks = [int(row[7]) for row in rows]
        assert sorted(ranks) == list(range(1, 9))
        assert ranks[half.index(best)] == 1
        assert sorted(range(8), key=lambda i: half[i].thesis_error) == sorted(
            range(8), key=lambda i: int(rows[i][10])
        )


def test_tables_of_the_appendix_hold_every_epoch(tmp_path: Path) -> None:
    ablation = made_up(_error)
    page = _page(ablation, tmp_path)
    for name, setting in zip(("A.1", "A.2"), SHOWN, strict=True):
        rows = _rows(page, f"### Table {name}: model {setting.model} ")
        assert len(rows) == EPOCHS
        for k, row in enumerate(rows):
            epochs = [training.epochs[k] for training in ablation.of(setting)]
            assert row == [
                f"{k + 1}",
                f"{1e6 * epochs[0].train_mse:.1f}",
                f"{100 * fmean(e.held_out_error for e in epochs):.3f}",
                f"{100 * fmean(e.validation_error for e in epochs):.3f}",
                f"{epochs[0].learning_rate:.2e}",
            ]
    assert _rows(page, "## Held-out objects, one by one")[0][1:] == [
        f"{100 * (_error(SHOWN[0], 1) + 1e-3 * i):.3f} ± 0.020" for i in range(len(HELD_OUT))
    ]


@pytest.mark.parametrize(("change", "verb"), [(-0.01, "lowers"), (0.01, "raises")])
def test_conclusions_follow_the_numbers(change: float, verb: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    noise = {(s, seed): rng.normal(0, 1e-4) for s in SETTINGS for seed in range(3)}
    page = _page(made_up(lambda s, k: 0.05 + change * s.use_com + noise[s, k]), tmp_path)
    section = " ".join(page[page.index("## What matters") : page.index("## Epochs")].split())
    told = re.search(r"largest first: told the centre of mass \((\w+) the error by ([\d.]+) mm\)",
                     section)  # fmt: skip
    assert told
    assert told[1] == verb
    assert float(told[2]) == pytest.approx(10, abs=0.2)
    assert "interval is that of one comparison: none is wider because there are 11 of" in section
    row = _rows(page, "## What matters")[0]
    assert (float(row[1]) < 0) == (change < 0)
    assert row[4] == ("yes" if change < 0 else "no")


def test_one_seed_claims_nothing(tmp_path: Path) -> None:
    page = _page(made_up(_error, (3,)), tmp_path)
    assert "±" not in page.replace("±0.738", "")
    assert "With one seed none of ours can be told from chance" in " ".join(page.split())


def test_the_orders_of_the_thesis_and_ours_are_compared(tmp_path: Path) -> None:
    same = " ".join(_page(made_up(lambda s, _: s.thesis_error), tmp_path).split())
    assert same.count("with the thesis' is 1.00, which is beyond what chance") == 2
    other = " ".join(_page(made_up(lambda s, _: 1 - s.thesis_error), tmp_path).split())
    assert other.count("with the thesis' is -1.00, which is beyond what chance") == 2


def test_the_plots_show_the_curves(tmp_path: Path) -> None:
    page = _page(made_up(_error), tmp_path)
    for name in ("best", "all"):
        assert f"(ablation_{name}.png)" in page
        image = imread(tmp_path / f"ablation_{name}.png")[..., :3]
        assert image.shape[1] > 900
        assert image.mean() > 0.85  # light
        red, green, blue = np.moveaxis(image, 2, 0)
        assert ((red > green + 0.3) & (red > blue + 0.3)).sum() > 500
        assert ((blue > red + 0.3) & (blue > green + 0.1)).sum() > 500
    before = (tmp_path / "ablation_best.png").read_bytes()
    _page(made_up(lambda s, seed: _error(s, seed) * (1 + s.use_com)), tmp_path)
    assert (tmp_path / "ablation_best.png").read_bytes() != before


def test_the_summary_names_the_best() -> None:
    ablation = made_up(lambda s, _: s.thesis_error)
    with_com, without = summary(ablation)
    assert "model 8 (3 layers, patches of 16, 16 heads): 8.210 ± 0.000 cm" in with_com
    assert "model 2 (2 layers, patches of 32, 16 heads): 13.750 ± 0.000 cm" in without


def test_a_page_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match=r"page\.md: its plots cannot be written: "):
        write_report(made_up(_error), tmp_path / "file" / "page.md")
