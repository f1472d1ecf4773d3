"""The thesis' ablation in a reproduction."""

from pathlib import Path

from keypush.learning.ablation.report import summary, write_report
from keypush.learning.ablation.results import read_ablation

PAGE = "ablation.md"


def write_ablation_page(folder: Path, out: Path) -> str:
    """Writes OUT/ablation.md and its plots; returns what `tables.md` says of them.

    Args:
        folder: of `keypush ablate`.
        out: of the reproduction.

    Raises:
        UserError: the folder holds no finished ablation, or a file cannot be written.
    """
    ablation = read_ablation(folder)
    write_report(ablation, out / PAGE)
    lines = "\n".join(f"- {line}" for line in summary(ablation))
    return f"[{PAGE}]({PAGE}) has them, beside the thesis'. In short:\n\n{lines}"
