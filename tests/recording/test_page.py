"""The page around Meshcat's viewer."""

import pytest

from keypush.recording.narration import Narration
from keypush.recording.page import dress_page

BARE = "<html><title>Drake MeshCat</title><body>scene</body></html>"


def test_words_are_escaped() -> None:
    page = dress_page(BARE, Narration("a<b", "p & q", "<script>"))
    assert "a&lt;b" in page
    assert "p &amp; q" in page
    assert page.count("<script>") == 1  # the time bar's own


def test_scene_stays_and_overlay_stands_after_it() -> None:
    page = dress_page(BARE, Narration("t", "p", "o"))
    assert page.index("scene") < page.index("keypush-time") < page.index("</body>")


def test_another_form_of_meshcats_page_is_refused() -> None:
    with pytest.raises(RuntimeError, match="no title"):
        dress_page("<html><body></body></html>", Narration("t", "p", "o"))
