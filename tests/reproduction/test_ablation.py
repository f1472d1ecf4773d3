"""The page of an ablation in a reproduction."""

from pathlib import Path

from keypush.learning.ablation.results import write_ablation
from keypush.reproduction.ablation import write_ablation_page
from tests.learning.ablation.sample import made_up


def test_the_page_and_its_plots_lie_beside_the_tables(tmp_path: Path) -> None:
    folder, out = tmp_path / "ablation", tmp_path / "out"
    write_ablation(made_up(lambda setting, _: 0.01 * setting.model), folder)
    text = write_ablation_page(folder, out)
    assert text.startswith("[ablation.md](ablation.md) has them")
    assert text.count("model 1 (2 layers, patches of 32, 8 heads)") == 2
    page = (out / "ablation.md").read_text()
    for table in ("(table 5.3)", "(table 5.4)", "Table A.1", "Table A.2", "figure 5.4"):
        assert table in page
    assert {path.name for path in out.iterdir()} == {
        "ablation.md", "ablation_all.png", "ablation_best.png",
    }  # fmt: skip
