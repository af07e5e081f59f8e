"""A scene's file, and sessions that draw it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from author import Author

from sdfc.diagnostics import DeviceError
from sdfc.gpu.device import open_device


@pytest.fixture(scope="session")
def gl() -> None:
    """OpenGL. Without it the test is skipped, unless SDFC_REQUIRE_GL=1 says that it must be there."""
    try:
        open_device().close()
    except DeviceError as error:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            raise
        pytest.skip(f"no OpenGL here: {error}")


@pytest.fixture
def authors(gl: None, tmp_path: Path) -> Iterator[Callable[[], Author]]:
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
