"""A scene's file, and sessions that draw it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from author import Author


@pytest.fixture
def authors(opengl: None, tmp_path: Path) -> Iterator[Callable[[], Author]]:
    """Makes authors, each in a folder of its own."""
    made: list[Author] = []

    def author() -> Author:
        folder = tmp_path / str(len(made))
        folder.mkdir()
        made.append(Author(folder))
        return made[-1]

    yield author
    for author_ in made:
        author_.session.close()


@pytest.fixture
def author(authors: Callable[[], Author]) -> Author:
    return authors()
