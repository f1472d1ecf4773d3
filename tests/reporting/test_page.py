"""The page and its Markdown twin say the same, and links, names and figures are sound."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from keypush.reporting.figure import number_drivers
from keypush.reporting.markdown import render_markdown
from keypush.reporting.outcome_figures import fan_out
from keypush.reporting.page import render_page
from keypush.reporting.rate_axis import RateAxis
from keypush.reporting.rate_figures import error_edges, keypoint_figure
from keypush.reporting.report import Report, build_report
from keypush.reporting.runs import Recording
from keypush.reporting.svg import WIDTH
from keypush.reporting.tally import Tally
from tests.reporting.made_up import failed, gathered, many_records, record
from tests.reporting.page_tables import read_tables

SVG = re.compile(r'<svg role="img".*?</svg>', re.DOTALL)
POINT = re.compile(r"(?:[ML]|translate\()(-?[\d.]+) (-?[\d.]+)")
"""Where a mark or a corner of a line lies."""


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    return build_report(gathered(tmp_path_factory.mktemp("run"), many_records()))


def test_page_and_markdown_hold_every_table(report: Report) -> None:
    tables = [table for section in report.sections for table in section.tables]
    grids = read_tables(render_page(report, []))
    assert grids == [[table.headings, *map(list, table.rows)] for table in tables]
    assert len(grids) == 8
    markdown = render_markdown(report)
    for table in tables:
        lines = [f"| {' | '.join(row)} |" for row in (table.headings, *table.rows)]
        assert [line for line in lines if line not in markdown.splitlines()] == []


def test_markdown_tables_have_as_many_cells_in_every_line(report: Report) -> None:
    lines = [line for line in render_markdown(report).splitlines() if line.startswith("|")]
    tables = re.split(r"\n\n+", render_markdown(report))
    widths = [{line.count("|") for line in t.splitlines()} for t in tables if t.startswith("|")]
    assert lines
    assert [len(width) for width in widths] == [1] * len(widths)


def test_what_a_policy_said_is_no_html_and_no_new_line(tmp_path: Path) -> None:
    said = "keypoint is <generator>;\nallowed: p < 1 | three numbers"
    records = [failed(policy="a\nb.py:P", outcome="policy_failed", reason=said)]
    markdown = render_markdown(build_report(gathered(tmp_path, records)))
    assert "keypoint is &lt;generator>; allowed: p < 1 \\| three numbers" in markdown
    assert "a b.py:P" in markdown
    assert "a\nb.py" not in markdown


def test_lead_and_facts_say_what_was_run(report: Report) -> None:
    facts = dict(report.facts)
    assert report.lead.startswith("4 policies pushed 9 objects")
    assert "1\N{NO-BREAK SPACE}728 episodes" in report.lead
    assert "no learning" in facts["centroid"]
    assert "weights surface_no_com.safetensors" in facts["surface_no_com"]
    assert facts["objects"] == "training objects: 4, unseen (similar): 2, unseen (different): 3"
    assert facts["episodes"] == "8 episodes per policy, condition and object"
    assert facts["conditions"].startswith("nominal; size 0.75; ")
    assert facts["seed"] == "0"


def test_every_drawing_stays_within_its_frame(report: Report) -> None:
    drawings = SVG.findall(render_page(report, []))
    assert len(drawings) > 15
    for svg in drawings:
        root = ET.fromstring(svg)
        height = float(root.attrib["height"])
        paths = [element for element in root.iter() if element.tag == "path"]
        places = [
            place
            for path in paths
            for place in POINT.findall(path.attrib.get("transform") or path.attrib["d"])
        ]
        assert places
        for x, y in places:
            assert 0 <= float(x) <= WIDTH, svg[:200]
            assert 0 <= float(y) <= height, svg[:200]


def test_figures_say_in_words_what_they_show(report: Report) -> None:
    for svg in SVG.findall(render_page(report, [])):
        assert len(ET.fromstring(svg).attrib["aria-label"]) > 20


def test_one_lone_success_is_a_report_too(tmp_path: Path) -> None:
    report = build_report(gathered(tmp_path, [record()]))
    assert report.lead == "1 policy pushed 1 object to a goal on a table, in 1 episode."
    titles = [section.title for section in report.sections]
    assert titles == [
        "Success", "Objects", "Failures", "Effort and keypoints", "Places", "How to read this",
    ]  # fmt: skip
    assert "<svg" in render_page(report, [])


def test_without_nominal_episodes_all_stand_in_their_place(tmp_path: Path) -> None:
    records = [record(size_ratio=0.75), failed(size_ratio=0.75, com_shift=0.01, episode=1)]
    report = build_report(gathered(tmp_path, records))
    assert report.sections[0].text == "Over all conditions, as no episode was nominal."
    assert report.sections[0].tables[0].rows[0][2] == "2"


def test_names_and_addresses_are_escaped(tmp_path: Path) -> None:
    records = [record(object="<b>&", policy='"mine"', weights="<i>.safetensors", set="user")]
    report = build_report(gathered(tmp_path, records))
    page = render_page(report, [Recording("<u>", "a & b", "x%20%22y.html")])
    for raw in ("<b>", '"mine"', "<i>", "<u>"):
        assert raw not in page
    assert 'href="x%20%22y.html">&lt;u&gt;</a>' in page


def test_the_page_is_the_same_every_time(tmp_path: Path) -> None:
    records = many_records(episodes=2)
    pages = [
        render_page(build_report(gathered(tmp_path / name, records)), []) for name in ("a", "b")
    ]
    assert pages[0] == pages[1]


@pytest.mark.parametrize(("successes", "low"), [(0, 0.0), (5, 0.2), (9, 0.5), (95, 0.8)], ids=str)
def test_axis_reaches_below_every_interval(successes: int, low: float) -> None:
    tallies = [Tally(10 if successes < 10 else 100, successes, successes)]
    axis = RateAxis(tallies, 0.0, 100.0)
    assert axis.low == pytest.approx(low)
    assert axis.at(tallies[0].interval[0]) >= 0
    assert axis.at(1.0) == 100
    ticks = axis.ticks()
    assert ticks[-1] == 1
    assert axis.low - 1e-9 <= ticks[0] < axis.low + ticks[1] - ticks[0]


def test_dots_of_one_place_lie_around_it() -> None:
    points = np.array([[10.0, 20.0], [50.0, 60.0], [10.0, 20.0], [10.0, 20.0], [50.0, 60.0]])
    laid = fan_out(points)
    assert np.array_equal(laid[:2], points[:2])
    gaps = np.linalg.norm(laid[:, None] - laid[None], axis=2)[~np.eye(5, dtype=bool)]
    assert gaps.min() > 2
    assert np.linalg.norm(laid - points, axis=1).max() < 4


def test_bins_hold_every_error() -> None:
    errors = np.array([0.003, 0.0199, 0.02, 0.4])
    edges = error_edges(errors)
    assert edges[0] <= errors.min()
    assert errors.max() < edges[-1]
    assert list(error_edges(np.array([0.006, np.nan]))) == [0.005, 0.01]


def test_episodes_without_an_error_are_drawn_beside_the_others(tmp_path: Path) -> None:
    nan = float("nan")
    records = [
        record(),
        failed(episode=1, keypoint_error=nan),
        failed(policy="behavior_cloning", keypoint_error=nan),
    ]
    episodes = gathered(tmp_path, records)
    figure = keypoint_figure(episodes, number_drivers(episodes.values("driver")), "nominal")
    (panel,) = figure.panels
    assert [entry.name for entry in figure.legend] == ["expert"]
    assert re.findall("<title>(.*?), [0-9.]+ %", panel.svg) == ["expert: 0 of 1", "expert: 1 of 1"]
    assert ">none</text>" in panel.svg
