"""`keypush report`: evaluations as a page, and as Markdown."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import tyro

from keypush.cli.output import check_output_file, write_output
from keypush.errors import UserError


@dataclass(kw_only=True)
class Report:
    """Turn evaluations into one self-contained page.

    It has success rates with 95 % intervals by policy, objects, size and condition, how episodes
    failed, policies compared on the same episodes, figures, and links to recordings.
    """

    after_interrupt: ClassVar[str] = "no report was written"

    runs: Annotated[tyro.conf.Positional[list[Path]], tyro.conf.arg(metavar="RUN...")]
    """Folders that `keypush evaluate` or `keypush reproduce` wrote; an episode that lies in
    several of them counts once."""
    out: Path = Path("out/report.html")
    """The page to write."""
    markdown: Path | None = None
    """A Markdown file to write too, with the same tables."""

    def run(self) -> None:
        """Runs the verb."""
        if not self.runs:
            raise UserError("no RUN is given; allowed: one or more folders of evaluations")
        if self.markdown is not None and self.markdown.resolve() == self.out.resolve():
            raise UserError(f"--out and --markdown are both {self.out}; allowed: two files")
        from keypush.reporting.differences import find_differences
        from keypush.reporting.episodes import gather_episodes
        from keypush.reporting.markdown import render_markdown
        from keypush.reporting.page import render_page
        from keypush.reporting.report import build_report
        from keypush.reporting.runs import find_recordings, read_runs

        table = read_runs(self.runs)
        report = build_report(gather_episodes(table), find_differences(table))
        if self.markdown is not None:
            check_output_file(self.markdown)  # Before the page is written: both or none.
        write_output(self.out, render_page(report, find_recordings(self.runs, self.out)))
        print(f"written: {self.out}")
        if self.markdown is not None:
            write_output(self.markdown, render_markdown(report))
            print(f"written: {self.markdown}")
