"""The page in a real, headless Chromium: on a phone, in the dark, without scripts."""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from keypush.reporting.page import render_page
from keypush.reporting.report import build_report
from keypush.reporting.runs import Recording
from tests.reporting.made_up import RATES, gathered, many_records

PHONE: ViewportSize = {"width": 390, "height": 844}
DESK: ViewportSize = {"width": 1200, "height": 900}
RECORDINGS = [Recording("mug-3", "runs/expert", "runs/expert/recordings/mug-3.html")]
LONG_NAME = "network_that_was_trained_for_a_very_long_time"
OVERFLOW = "document.documentElement.scrollWidth - window.innerWidth"
BODY_COLOURS = """(() => { const style = getComputedStyle(document.body);
    return [style.backgroundColor, style.color]; })()"""
DRAWN_COLOURS = """[...document.querySelectorAll("svg text, svg .mark, svg .bar")]
    .map(element => getComputedStyle(element).fill)"""
SMALL_TEXT = """[...document.querySelectorAll("svg text")].filter(text =>
    text.getBoundingClientRect().height < 11).length"""
WIDE_BOXES = """[...document.querySelectorAll(".scroll")].filter(box =>
    box.scrollWidth > box.clientWidth).length"""


@dataclass
class Opened:
    """A page, and what it said and asked for while it was open."""

    page: Page
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def evaluate(self, script: str) -> Any:
        return self.page.evaluate(script)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("no chromium on the PATH (Debian's package: chromium)")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    varied = [{"size_ratio": 1.0}, {"size_ratio": 0.75}, {"com_shift": 0.015}]
    records = many_records({**RATES, LONG_NAME: 0.7}, conditions=varied, episodes=3)
    html = render_page(build_report(gathered(folder / "run", records)), RECORDINGS)
    path = folder / "report.html"
    path.write_text(html, encoding="utf-8")
    return path


def _open(browser: Browser, file: Path, size: ViewportSize, **settings: Any) -> Opened:
    for context in browser.contexts:
        context.close()
    page = browser.new_context(viewport=size, **settings).new_page()
    opened = Opened(page)
    page.on("console", lambda message: opened.complaints.append(message.text))
    page.on("pageerror", lambda error: opened.complaints.append(str(error)))
    page.on("request", lambda request: opened.requests.append(request.url))
    page.goto(file.as_uri())
    return opened


def test_page_is_silent_and_asks_for_nothing(browser: Browser, file: Path) -> None:
    opened = _open(browser, file, DESK)
    assert opened.complaints == []
    outside = [url for url in opened.requests if not url.startswith("data:")]
    assert outside == [file.as_uri()]


@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_page_does_not_scroll_sideways(browser: Browser, file: Path, size: ViewportSize) -> None:
    assert _open(browser, file, size).evaluate(OVERFLOW) == 0


def test_on_a_phone_tables_scroll_in_their_box_and_figures_stay_legible(
    browser: Browser, file: Path
) -> None:
    opened = _open(browser, file, PHONE)
    assert opened.evaluate(WIDE_BOXES) >= 5
    assert opened.evaluate(SMALL_TEXT) == 0


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_and_drawings_stand_out_in_both_schemes(
    browser: Browser, file: Path, scheme: str
) -> None:
    opened = _open(browser, file, DESK, color_scheme=scheme)
    background, text = (_luminance(colour) for colour in opened.evaluate(BODY_COLOURS))
    assert (background < 0.02) if scheme == "dark" else (background > 0.9)
    assert _contrast(background, text) > 12
    drawn = {_luminance(colour) for colour in opened.evaluate(DRAWN_COLOURS)}
    assert len(drawn) > 8
    assert min(_contrast(background, colour) for colour in drawn) > 3


def test_without_scripts_tables_are_there(browser: Browser, file: Path) -> None:
    page = _open(browser, file, PHONE, java_script_enabled=False).page
    assert page.locator("table").count() == 8
    assert page.locator("table").first.is_visible()
    assert page.get_by_role("rowheader", name="unseen (both)").first.is_visible()
    assert page.get_by_role("img").first.is_visible()


def test_recordings_are_linked_from_the_pages_place(browser: Browser, file: Path) -> None:
    page = _open(browser, file, DESK).page
    link = page.get_by_role("link", name="mug-3")
    address = link.evaluate("link => link.href")
    assert address == (file.parent / RECORDINGS[0].address).as_uri()


def _luminance(colour: str) -> float:
    """Relative luminance of "rgb(r, g, b)", as WCAG 2 defines it."""
    parts = colour.removeprefix("rgb(").removesuffix(")").split(",")
    red, green, blue = (_linear(float(part) / 255) for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _linear(value: float) -> float:
    return value / 12.92 if value <= 0.04045 else float(((value + 0.055) / 1.055) ** 2.4)


def _contrast(one: float, other: float) -> float:
    dark, light = sorted((one, other))
    return (light + 0.05) / (dark + 0.05)
