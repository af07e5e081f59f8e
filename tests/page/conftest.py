"""One browser, and one scene that is watched, for all tests of the page."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest
from devtools import Browser, Open, Tab
from servers import SCENE, Watch


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with closing(Browser()) as opened:
        yield opened


@pytest.fixture(scope="session")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watch]:
    with closing(Watch(tmp_path_factory.mktemp("watched"))) as opened:
        yield opened


@pytest.fixture
def watch(watched: Watch) -> Watch:
    """With the scene that every test begins with."""
    if watched.scene.read_text() != SCENE:
        watched.save(SCENE)
    return watched


@pytest.fixture
def page(browser: Browser, watched: Watch) -> Iterator[Open]:
    """Opens the page, and waits for its picture. At the end nothing may have been complained of."""
    tabs: list[Tab] = []

    def opened(url: str | None = None, **seen: Any) -> Tab:
        tab = browser.open(**seen)
        tabs.append(tab)
        tab.go(url or watched.url)
        tab.until("document.querySelector('#waiting')?.hidden")
        tab.rest()
        return tab

    yield opened
    complaints = [complaint for tab in tabs for complaint in tab.complaints()]
    for tab in tabs:
        tab.close()
    assert complaints == []
