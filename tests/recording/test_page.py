"""The page around Meshcat's viewer."""

import pytest
from pydrake.geometry import Rgba

from keypush.recording.page import dress_page

LEGEND = [(Rgba(1, 0, 0, 1), "r < s")]
BARE = "<html><title>Drake MeshCat</title><body>scene</body></html>"


def test_words_are_escaped() -> None:
    page = dress_page(BARE, "a<b", ["p & q", "<script>"], LEGEND, time_bar=True)
    assert "r &lt; s" in page
    assert "a&lt;b" in page
    assert "p &amp; q" in page
    assert page.count("<script>") == 1  # the time bar's own


def test_scene_stays_and_overlay_stands_after_it() -> None:
    page = dress_page(BARE, "t", ["p", "o"], LEGEND, time_bar=True)
    assert page.index("scene") < page.index("keypush-time") < page.index("</body>")


def test_a_page_without_a_recording_has_no_time_bar() -> None:
    page = dress_page(BARE, "t", ["p"], LEGEND, time_bar=False)
    assert "keypush-story" in page
    assert "keypush-time" not in page.replace("#keypush-time", "")


def test_another_form_of_meshcats_page_is_refused() -> None:
    with pytest.raises(RuntimeError, match="no title"):
        dress_page("<html><body></body></html>", "t", ["p"], LEGEND, time_bar=True)
